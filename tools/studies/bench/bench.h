#pragma once
#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "sim/io/json.h"
#include "tools/run/frame/job_options.h"

namespace tools {

/// Command-line options of `raywatt bench`.
struct BenchOptions {
  JobOptions job;  ///< `job.threads` applies to multi-threaded measurements only
  std::vector<std::string> scenes = {"cornell", "teapot"};
  std::uint32_t runs = 5;
  std::filesystem::path saved_metrics;  ///< file of saved metrics, used instead of measuring; empty: measure
  std::filesystem::path against;        ///< file of metrics to compare with; empty: none
};

/// A benchmark metric that is measured for each scene: a key of the JSON output and a column of the table.
struct BenchMetric {
  enum class Kind : std::uint8_t {
    kRate,   ///< a rate per second; more is better
    kTimes,  ///< a factor; more is better
    kCost,   ///< a cost; less is better
    kFact,   ///< independent of speed; not compared
  };
  std::string name, header;
  Kind kind = Kind::kRate;
  bool is_partial = false;  ///< measured on a replayed trace or on sampled tiles
};
const std::vector<BenchMetric>& bench_metrics();

/// Measures the speed of the simulator on each scene and returns JSON, schema raywatt-bench/2. Each metric is the
/// median over `runs` rounds. Each scene has its own process, because peak memory never falls. If such a process fails,
/// this process exits with the same code. `other`: result to compare with, or null; if a scene is not comparable with
/// it, InputError is thrown before the scene is measured.
sim::Json measure_scenes(const BenchOptions& options, const sim::Json* other = nullptr);

/// Reads a file of `raywatt bench --json`. Several results in one file are merged to medians. Throws InputError for
/// other contents.
sim::Json load_bench(const std::filesystem::path& file);

/// Throws InputError if two benchmark results are not comparable: a common scene has another resolution, machine or
/// number of threads. With `require_common_scene` also if they have no common scene. JSON members that older versions
/// did not write are ignored. `file`: path of `other`, for messages.
void check_comparable(const sim::Json& bench, const sim::Json& other, const std::filesystem::path& file,
                      bool require_common_scene = true);

/// Adds the member `against` to each scene of `bench` that `other` also has: the factor by which each metric is better.
void compare_bench(sim::Json& bench, const sim::Json& other);

/// Returns the results as tables for a terminal: first whole runs, then replays and sampled runs. With `against`, both
/// tables are repeated with the factors by which metrics are better.
std::string bench_table(const sim::Json& bench);

/// Returns the median of at least one value.
inline double median(std::vector<double> values) {
  std::ranges::sort(values);
  return (values[(values.size() - 1) / 2] + values[values.size() / 2]) / 2;
}

}  // namespace tools
