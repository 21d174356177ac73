#pragma once
#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "sim/report/energy.h"
#include "sim/report/energy_table.h"
#include "tools/analysis/report.h"
#include "tools/analysis/report_file.h"
#include "tools/run/frame/load_config.h"

namespace tools {

/// A figure of the energy tables, or a curve of figures over size, bound to a configuration.
struct EnergyEntry {
  std::string name;  ///< "energy.events.cache.l1_read", "energy.clock_share", "dram.energy.refresh"
  std::string unit;
  std::string meaning;  ///< meaning of its key
  std::uint64_t hash = 0;
  /// A figure of the configuration, and its band before any draw.
  struct Figure {
    std::string name;  ///< with its size, "energy.events.cache.l1_read@16KiB"
    sim::Band* value;
    sim::Band band;
  };
  std::vector<Figure> figures;  ///< points of the curve, or one

  bool has_band() const;
  /// Sets the nominal figure of each point to a quantile of its band.
  void set_quantile(double quantile);
  void restore_nominal();
};

/// Returns the entries of all tables, including those without a band, in the order of the configuration. `config` must
/// outlive them.
std::vector<EnergyEntry> energy_entries(RunConfig& config);

/// Returns the figure at a quantile of its band: low at 0, nominal at 1/2, high at 1. Between them it interpolates the
/// logarithm, or the figure itself if low is 0.
double at_quantile(const sim::Band& band, double quantile);

/// Independent draws of all entries. Entries of one name have the same quantile in all designs and at all points of a
/// curve.
struct EnergyDraw {
  std::uint64_t seed = 1;
  std::uint64_t number = 0;
  double quantile_of(const EnergyEntry& entry) const;
};

/// Energy figures that replace those of the run.
struct PriceTable {
  std::string energy{};             ///< a whole table, as energy.extends names it; empty: the run's
  std::vector<std::string> sets{};  ///< "key=value" of keys that affect energy alone
  bool is_own() const { return energy.empty() && sets.empty(); }
};

/// A finished run, priced without simulation: the counts of its report on the machine of its configuration.
///
///   report.json: config ──► machine at rest: what each counter costs ──► formula x table ──► joules
///                units  ──► counts ──────────────────────────────────────┘
class PricedRun {
 public:
  /// Throws InputError if the report has no counts, if they do not give the reported energy under the run's own table
  /// (the report was made by another model), or if the table does not fit.
  explicit PricedRun(const ReportFile& report, const PriceTable& table = {});
  PricedRun(const PricedRun&) = delete;
  PricedRun& operator=(const PricedRun&) = delete;

  const RunConfig& config() const { return config_; }
  sim::EnergyReport energy() const { return formula_->compute_report(); }
  const WorkDone& work() const { return work_; }
  /// Returns a line for each kind of unit whose array is outside all points of a curve of the table, and for each clock
  /// whose energies hold at another voltage.
  const std::vector<std::string>& extrapolation_warnings() const { return extrapolated_; }

  /// Returns the figures that have a band.
  std::vector<EnergyEntry>& band_entries() { return entries_; }
  /// Sets nominal figures to those of a draw; restore() sets them back to the table's.
  void apply_draw(const EnergyDraw& draw);
  void restore_nominal();
  /// Recomputes the formula; call after changing entries directly.
  void update_formula();

  /// Returns the current pJ of one side.
  double total(sim::BandMember side) const { return formula_->total_pj(side); }
  double of_block(const std::string& block, sim::BandMember side) const;
  /// Returns the pJ of a frame and of the idle rest of its period at the rate frame.fps, which is above 0.
  double of_period(sim::BandMember side) const;

 private:
  void make_formula(const std::vector<sim::UnitReport>& units);

  RunConfig config_;
  WorkDone work_;
  sim::Time elapsed_ = 0;
  std::map<std::string, sim::DeviceEvent> device_;
  std::unique_ptr<sim::EnergyFormula> formula_;
  std::unique_ptr<sim::EnergyFormula> idle_;  ///< of a millisecond without work
  std::vector<EnergyEntry> entries_;
  std::vector<std::string> extrapolated_;
};

}  // namespace tools
