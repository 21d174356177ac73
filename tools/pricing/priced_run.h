#pragma once
#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "sim/report/energy.h"
#include "tools/analysis/report.h"
#include "tools/analysis/report_file.h"
#include "tools/run/frame/frame_rate.h"
#include "tools/run/frame/load_config.h"

namespace tools {

/// An entry of the energy tables in a configuration: a value, or a curve of values over size.
struct EnergyEntry {
  std::string name;  ///< name of the entry: "energy.events.cache.l1_read", "energy.clock_share", "dram.energy.refresh"
  std::string unit;
  std::string meaning;  ///< description of the entry's configuration key
  std::uint64_t hash = 0;
  /// One value in an entry of the energy tables, and its band before any random draw.
  struct Figure {
    std::string name;  ///< name of the entry, for a curve with the size: "energy.events.cache.l1_read@16KiB"
    sim::Band* value;
    sim::Band band;
  };
  std::vector<Figure> figures;  ///< the points of the curve, or the only value

  bool has_band() const;
  /// Sets the nominal value of each point of the entry to a quantile of its band.
  void set_quantile(double quantile);
  void restore_nominal();
};

/// Returns the entries of all energy tables, including entries without a band, in the order of the configuration's
/// keys. `config` must outlive them.
std::vector<EnergyEntry> energy_entries(RunConfig& config);

/// Returns the value at a quantile of its band: low at 0, nominal at 1/2, high at 1. Values between them are
/// interpolated in the logarithm, or linearly if low is 0.
double value_at_quantile(const sim::Band& band, double quantile);

/// A random draw of all table entries: an independent quantile for each name. Entries with the same name have the same
/// quantile in all designs, at all points of a curve.
struct EnergyDraw {
  std::uint64_t seed = 1;
  std::uint64_t number = 0;
  double quantile_of(const EnergyEntry& entry) const;
};

/// Energy table that replaces the table of a run.
struct PriceTable {
  std::string energy{};             ///< name of a whole energy table, as for energy.extends; empty: the run's own table
  std::vector<std::string> sets{};  ///< "key=value" for keys that affect only energy
  bool is_own_table() const { return energy.empty() && sets.empty(); }
};

/// Computes the energy of a finished run without simulation, from the counts in its report and its configuration.
///
///   report.json: config ──► units: energy event of each counter ──► formula x table ──► joules
///                units  ──► counts ─────────────────────────────┘
class PricedRun {
 public:
  /// Throws InputError if the report has no counts or `table` does not fit the machine. It also throws if the counts do
  /// not give the reported energy under the run's own table, because another model made the report.
  explicit PricedRun(const ReportFile& report, const PriceTable& table = {});
  PricedRun(const PricedRun&) = delete;
  PricedRun& operator=(const PricedRun&) = delete;

  const RunConfig& config() const { return config_; }
  sim::EnergyReport energy() const { return formula_->compute_report(); }
  const WorkDone& work() const { return work_; }
  /// Returns a warning for each kind of unit whose array size is outside a curve of the energy table, and for each
  /// clock whose energies are for another voltage.
  const std::vector<std::string>& extrapolation_warnings() const { return extrapolated_; }

  /// Returns the energy table entries that have a band: a low, a nominal and a high value.
  std::vector<EnergyEntry>& band_entries() { return entries_; }
  /// Sets the nominal energy values to those of a random draw; restore_nominal() undoes it.
  void apply_draw(const EnergyDraw& draw);
  void restore_nominal();
  /// Recomputes the energy formula; call it after changing band_entries() directly.
  void update_formula();

  /// Returns the run's energy in pJ under the low, nominal or high values.
  double total(sim::BandMember side) const { return formula_->total_pj(side); }
  double block_energy_pj(const std::string& block, sim::BandMember side) const;
  /// Returns the mean energy in pJ of a frame period at the target rate frame.fps (above 0): a frame and the idle time
  /// after it.
  double period_energy_pj(sim::BandMember side) const;

 private:
  void build_energy_formula(const std::vector<sim::UnitReport>& units);

  RunConfig config_;
  WorkDone work_;
  sim::Time elapsed_ = 0;
  std::map<std::string, sim::DeviceEvent> device_;
  std::unique_ptr<sim::EnergyFormula> formula_;
  std::unique_ptr<sim::EnergyFormula> idle_;  ///< energy formula for a millisecond without work
  std::vector<EnergyEntry> entries_;
  std::vector<std::string> extrapolated_;
};

/// Evaluates the frames of a finished run at the target rate `fps`, with the run's own energy table. Throws InputError
/// if PricedRun cannot compute the energy of the run.
FrameRate evaluate_report_rate(const ReportFile& report, double fps);

/// Sets at_fps, power_at_fps_w and fps_margin in a report's totals to the values of a run with frame.fps = `fps`.
/// Removes their statistics over replicates, and metrics of a sustained run at another rate. Throws InputError like
/// evaluate_report_rate().
void set_frame_rate(ReportFile& report, double fps);

}  // namespace tools
