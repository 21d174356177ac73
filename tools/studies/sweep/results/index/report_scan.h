#pragma once
#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <unordered_map>
#include <utility>
#include <vector>

#include "tools/studies/sweep/results/index/value.h"

namespace tools::results {

/// Numbers the paths of metrics in the order in which they are first met.
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

/// Figures that the index keeps of every frame: paths within an entry of a report's `frames`.
inline constexpr std::array kFrameFigures = {"frame",           "cycles",     "time_ms",           "rays.total",
                                             "traversal_steps", "dram_bytes", "energy_mj.nominal", "power_w.nominal",
                                             "traced_ratio",    "psnr_db"};
using FrameFigures = std::array<Value, kFrameFigures.size()>;

/// Members of its `host`.
inline constexpr std::array kHostFacts = {"name", "date", "threads", "wall_s", "timing_s", "rays_per_s", "peak_rss_mb"};
using HostFacts = std::array<Value, kHostFacts.size()>;

/// The part of a report that an index holds.
struct ReportScan {
  std::vector<std::pair<std::uint32_t, Value>> metrics;  ///< scalars of `totals`: number of the path, value
  std::vector<FrameFigures> frames;
  HostFacts host;
};

/// Reads a report in one pass, without building a tree of it. Returns what is wrong with it, if anything: it is cut
/// off, no report, or of an interrupted run.
std::optional<std::string> scan_report(std::string_view json, MetricNames& names, ReportScan& scan);

}  // namespace tools::results
