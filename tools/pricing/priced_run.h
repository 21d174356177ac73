#pragma once
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "sim/report/energy_formula.h"
#include "tools/analysis/cost_totals.h"
#include "tools/analysis/report_file.h"
#include "tools/pricing/energy_entries.h"
#include "tools/run/frame/load_config.h"

namespace tools {

/// Figures in the place of those that a run was made with.
struct PriceTable {
  std::string energy{};             ///< a whole table, as energy.extends names it; empty: the run's
  std::vector<std::string> sets{};  ///< "key=value" of keys that affect energy alone
  bool is_own() const { return energy.empty() && sets.empty(); }
};

/// A finished run, priced without simulation: the counts of its report, on the machine of its configuration.
///
///   report.json: config ──► machine at rest: what each counter costs ──► formula x table ──► joules
///                units  ──► counts ──────────────────────────────────────┘
class PricedRun {
 public:
  /// InputError if the report has no counts, if by its own table these do not come to the energy that it states (it was
  /// made by another model), or for a table that does not fit.
  explicit PricedRun(const ReportFile& report, const PriceTable& table = {});
  PricedRun(const PricedRun&) = delete;
  PricedRun& operator=(const PricedRun&) = delete;

  const RunConfig& config() const { return config_; }
  sim::EnergyReport energy() const { return formula_->report(); }
  const WorkDone& work() const { return work_; }
  /// A line for each kind of unit whose array lies outside all points of a curve of the table, and for each clock whose
  /// energies hold at another voltage.
  const std::vector<std::string>& extrapolated() const { return extrapolated_; }

  /// Figures with a band.
  std::vector<EnergyEntry>& entries() { return entries_; }
  /// Has nominal figures be those of a draw, or of the table again.
  void draw(const EnergyDraw& draw);
  void restore();
  /// Call when entries have been set by hand.
  void refresh();

  /// pJ of one side now.
  double total(sim::Side side) const { return formula_->total(side); }
  double of_block(const std::string& block, sim::Side side) const;

 private:
  void make_formula(const std::vector<sim::UnitReport>& units);

  RunConfig config_;
  WorkDone work_;
  sim::Time elapsed_ = 0;
  std::map<std::string, sim::DeviceEvent> device_;
  std::unique_ptr<sim::EnergyFormula> formula_;
  std::vector<EnergyEntry> entries_;
  std::vector<std::string> extrapolated_;
};

}  // namespace tools
