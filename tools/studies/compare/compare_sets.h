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
  std::string name;  ///< name for display
  std::vector<ReportFile> runs;
};

/// True for a folder that has no report itself, but contains folders of runs.
bool is_run_set(const std::filesystem::path& folder);
/// Reads the runs in the folders of a set, in the order of their names. Throws InputError like load_report().
RunSet load_run_set(const std::filesystem::path& folder);

/// A metric of two run sets (`a`, `b`) on one workload, or an aggregate over all workloads.
struct SetRow {
  std::string
      workload;  ///< name of the workload, "mean", "geomean", "worst", or "all" for a metric of the machine alone
  std::optional<double> a, b;
  std::optional<NoisyDifference> noise{};
};
struct SetRows {
  std::string name, label;  ///< name in JSON; path that tables show
  std::vector<SetRow> rows;
};

/// A comparison of two sets of runs on the same workloads.
struct SetComparison {
  std::vector<std::string> workloads;  ///< names, as short as possible while they differ
  std::vector<Comparison> runs;        ///< by workload
  std::vector<KeyPair> config;         ///< keys that differ equally on all workloads
  std::vector<SetRows> metrics;        ///< main metrics in table order; a metric of the machine alone has one row
  std::vector<SetRows> requested;      ///< metrics that the user named; if there are any, tables show only these
};

/// Compares the runs of two sets on each workload: runs with equal scene, resolution, frames and view. `requested`:
/// further metrics, as "mean(fps)" or "on(chess, power_w)". Throws InputError if a set lacks a workload of the other or
/// has two runs of one, and for metrics that the reports do not have.
SetComparison compare_sets(const RunSet& a, const RunSet& b, std::span<const std::string> requested = {});

/// Returns the comparisons of all other run sets with the first as text for a terminal.
std::string set_comparison_text(std::span<const RunSet> sets, std::span<const SetComparison> against);
/// Returns comparisons of run sets, and of their runs on each workload, as JSON (schema raywatt-compare-sets/1).
sim::Json set_comparison_json(std::span<const RunSet> sets, std::span<const SetComparison> against);
/// Returns warnings on the reliability of comparisons of run sets, a line each.
std::vector<std::string> set_comparison_warnings(std::span<const RunSet> sets, std::span<const SetComparison> against);

}  // namespace tools
