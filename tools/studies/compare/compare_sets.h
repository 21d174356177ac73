#pragma once
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "sim/io/json.h"
#include "tools/analysis/report_file.h"
#include "tools/studies/compare/compare.h"

namespace tools {

/// Runs of one machine on several workloads.
struct RunSet {
  std::string name;  ///< as it is shown
  std::vector<ReportFile> runs;
};

/// True for a folder that has no report, but folders of runs.
bool is_run_set(const std::filesystem::path& folder);
/// Reads the runs in the folders of a set, in the order of their names. Throws InputError like load_report().
RunSet load_run_set(const std::filesystem::path& folder);

/// A metric of two sets on one workload, or over all of them.
struct SetRow {
  std::string workload;  ///< name of the workload, "geomean" or "worst"
  std::optional<double> a, b;
  std::optional<NoisyDifference> noise{};
};
struct SetRows {
  std::string name, label;  ///< name in JSON; path that tables show
  std::vector<SetRow> rows;
};

/// A comparison of two sets of runs on the same workloads.
struct SetComparison {
  std::vector<std::string> workloads;  ///< names, as short as they differ
  std::vector<Comparison> runs;        ///< by workload
  std::vector<KeyPair> config;         ///< keys that differ equally on all workloads
  std::vector<SetRows> metrics;        ///< main metrics in table order; a metric of the machine alone has one row
};

/// Matches the runs of two sets by scene, resolution, frames and view, and compares them. Throws InputError if a
/// workload is missing in one of the sets, or twice in one.
SetComparison compare_sets(const RunSet& a, const RunSet& b);

/// Returns comparisons of the first set with each other one as text for a terminal.
std::string set_comparison_text(std::span<const RunSet> sets, std::span<const SetComparison> against);
/// Returns the same with all metrics and, by workload, the comparison of runs; schema raywatt-compare-sets/1.
sim::Json set_comparison_json(std::span<const RunSet> sets, std::span<const SetComparison> against);
/// Returns warnings on the reliability of the comparison, a line each.
std::vector<std::string> set_comparison_warnings(std::span<const RunSet> sets, std::span<const SetComparison> against);

}  // namespace tools
