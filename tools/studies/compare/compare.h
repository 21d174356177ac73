#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "tools/analysis/report.h"
#include "tools/analysis/report_file.h"
#include "tools/host/progress.h"
#include "tools/pricing/energy_study.h"

namespace tools {

/// The values of one metric in two runs, `a` and `b`.
struct MetricPair {
  std::string name;
  double a = 0, b = 0;
  std::optional<NoisyDifference> noise{};  ///< noise of the difference, if the metric is noisy
  std::string label{};                     ///< name in tables, of a metric of `totals`
  double difference() const { return b - a; }
};

/// A configuration key whose values differ between two runs; a value is empty if the run does not have the key.
struct KeyPair {
  std::string key, a, b;
};

/// The energy ratio of two runs under low, nominal and high energy tables.
struct EnergyBands {
  EnergyRatio gpu, tni;
  std::vector<TornadoBar> tornado;  ///< table entries that change the energy ratio of the GPU with memory most
};

/// A comparison of two runs.
struct Comparison {
  std::vector<std::string> other_work;  ///< differences in the work of the runs; empty: equal work
  std::vector<KeyPair> config;
  bool other_clock = false;         ///< the T&I clocks differ, so that cycles cannot be compared
  std::vector<MetricPair> metrics;  ///< the main metrics, in table order
  // Lists that explain the differences. They begin with the largest difference and leave out equal values.
  std::vector<MetricPair> time;  ///< T&I cycles of an average core, by part of totals.top_down
  /// T&I cycles of an average unit, by kind of unit and cycle reason; without idle reasons.
  std::vector<MetricPair> reasons;
  std::vector<MetricPair> blocks;     ///< nominal mJ by block
  std::vector<MetricPair> events;     ///< nominal mJ by block and event, and of clock and leakage
  std::vector<MetricPair> counters;   ///< sums over all units of a kind, by relative change; only changes of more than
                                      ///< 1 % of the number of rays
  std::vector<MetricPair> ratios;     ///< hit rates and mean times, from the core to the DRAM
  std::optional<EnergyBands> energy;  ///< none if a run cannot be priced
  std::string no_energy;              ///< reason that there is no `energy`
  // Comparison of the first frame's pictures.
  std::optional<double> squared_error;
  std::string no_picture;  ///< reason that there is no squared_error

  /// True if the metric cannot be compared because it counts cycles of different clocks.
  bool is_meaningless(std::string_view metric) const { return other_clock && metric == "cycles"; }
};

/// Simulates `count` replicates of the run of a report (docs/noise.md) and adds their statistics to the report, unless
/// it has as many already. Throws InputError if the run cannot be repeated.
void add_replicates(ReportFile& report, std::uint32_t count, std::uint32_t threads, Progress* progress);

/// Compares the run of report `b` with the run of report `a`; changes are relative to `a`.
Comparison compare(const ReportFile& a, const ReportFile& b);

/// Returns as JSON (schema raywatt-compare/1) the comparison of each other report with the first.
sim::Json comparison_json(const std::vector<ReportFile>& reports, const std::vector<Comparison>& against);

/// Returns the comparisons of all other reports with the first as text for a terminal.
std::string comparison_text(const std::vector<ReportFile>& reports, const std::vector<Comparison>& against);

/// Formats a value of a main metric with its unit. `name`: the metric's name in JSON.
std::string metric_value_text(const std::string& name, double value);
/// Returns a change as text: "+1.4 %", "x2.08", "new", "gone", "=".
std::string change_text(const MetricPair& pair);
/// States how the difference of a metric compares with its noise: "within ± 2 %", or for means of replicates "mean +1.4
/// % ± 0.52 %, outside". Empty for a metric without noise.
std::string noise_text(const MetricPair& pair);
/// Returns a line per configuration key with both values.
std::string config_text(const std::vector<KeyPair>& keys);
/// Returns the noise of a difference as a JSON object with the members from, difference, half_width, outside.
sim::Json noise_json(const NoisyDifference& noise);

/// Returns the folder names of the runs, with a letter in front if two are equal.
std::vector<std::string> short_names(const std::vector<ReportFile>& reports);

/// Returns warnings on the reliability of the comparison, a line each.
std::vector<std::string> comparison_warnings(const std::vector<ReportFile>& reports,
                                             const std::vector<Comparison>& against);

}  // namespace tools
