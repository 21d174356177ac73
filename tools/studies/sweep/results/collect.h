#pragma once
#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <unordered_map>
#include <utility>
#include <vector>

#include "tools/studies/sweep/results/results.h"
#include "tools/studies/sweep/store/store.h"

namespace tools::results {

struct Collected {
  StatusCounts counts;
  bool unchanged = false;  ///< no input had changed since the last collection, so nothing was written
};

/// Writes a sweep's index.sqlite from points.jsonl and the result store, and results.csv from the index. A sweep that
/// lists workloads also gets machines.csv. Each file is replaced atomically. Does nothing if no input has changed.
/// Waits while another process collects the same sweep. Throws InputError for a damaged list of points.
Collected collect_results(const sweep::SweepFolder& folder);
/// Calls collect_results(). If the folder is read-only but has an index, it only prints a warning that ends with
/// `consequence`.
void collect_if_writable(const std::filesystem::path& sweep, std::string_view consequence);

/// Returns the numbers of points by status as text: "200 points: 198 done, 2 failed".
std::string summary_text(const Collected& collected);

/// Returns the status of a point for tables: Store::status_of(), except that a damaged failure file counts as failed.
PointStatus listed_status(const sweep::Store& store, const std::string& id);

/// Gives each metric path a number, from 0 in the order of first use.
class MetricNames {
 public:
  std::uint32_t number_of(std::string_view path) {
    if (const auto found = numbers_.find(path); found != numbers_.end()) return found->second;
    const auto number = static_cast<std::uint32_t>(names_.size());
    numbers_.emplace(path, number);
    names_.emplace_back(path);
    return number;
  }
  const std::vector<std::string>& names() const { return names_; }

 private:
  struct Hash {
    using is_transparent = void;
    std::size_t operator()(std::string_view text) const { return std::hash<std::string_view>()(text); }
  };
  std::unordered_map<std::string, std::uint32_t, Hash, std::equal_to<>> numbers_;
  std::vector<std::string> names_;
};

/// Paths whose values the index stores: kFrameFigures in each entry of a report's `frames`, kHostFacts in its `host`.
inline constexpr std::array kFrameFigures = {"frame",           "cycles",     "time_ms",           "rays.total",
                                             "traversal_steps", "dram_bytes", "energy_mj.nominal", "power_w.nominal",
                                             "traced_ratio",    "psnr_db"};
inline constexpr std::array kHostFacts = {"name", "date", "threads", "wall_s", "timing_s", "rays_per_s", "peak_rss_mb"};

/// The values of a report that the index stores.
struct ReportScan {
  std::vector<std::pair<std::uint32_t, Value>> metrics;  ///< scalars of `totals`: number of path, value
  std::vector<std::array<Value, kFrameFigures.size()>> frames;
  std::array<Value, kHostFacts.size()> host;
};
/// Reads the text of a report into `scan`. Returns an error message if the text is truncated, is not a report, or is
/// from an interrupted run.
std::optional<std::string> scan_report(std::string_view text, MetricNames& names, ReportScan& scan);

}  // namespace tools::results
