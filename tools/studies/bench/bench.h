#pragma once
#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "sim/io/json.h"
#include "tools/run/frame/job_options.h"

namespace tools {

/// Options of `raywatt bench`.
struct BenchOptions {
  JobOptions job;  ///< `threads` is for the run with all threads
  std::vector<std::string> scenes = {"cornell", "teapot"};
  std::uint32_t runs = 5;
  std::filesystem::path saved_metrics;  ///< saved metrics, used instead of measuring; may be empty
  std::filesystem::path against;        ///< metrics to compare with; may be empty
};

/// A metric of a scene: a key of the JSON, a column of a table.
struct BenchMetric {
  enum class Kind : std::uint8_t {
    kRate,   ///< per second, and more is better
    kTimes,  ///< more is better
    kCost,   ///< less is better
    kFact,   ///< does not depend on speed; not compared
  };
  std::string name, header;
  Kind kind = Kind::kRate;
  bool is_partial = false;  ///< measured on a replayed trace or on sampled tiles
};
const std::vector<BenchMetric>& bench_metrics();

/// Measures the scenes, each in its own process because peak memory never falls; schema raywatt-bench/2. Each metric is
/// the median over `runs` rounds. If the process of a scene fails, this process exits with the same code. It exits
/// before measuring if a scene is not comparable with `other`.
sim::Json measure_scenes(const BenchOptions& options, const sim::Json* other = nullptr);

/// Reads the output of `raywatt bench --json`; returns medians if there are several results. Throws InputError.
sim::Json load_bench(const std::filesystem::path& file);

/// Throws InputError if a common scene has another frame, machine or number of threads, and with `require_common_scene`
/// if there is no common scene. Members that one of them lacks, because of an older build, are not compared. `file`:
/// path of `other`, for messages.
void check_comparable(const sim::Json& bench, const sim::Json& other, const std::filesystem::path& file,
                      bool require_common_scene = true);

/// Adds `against` to each scene that `other` also has: the factor by which each metric is better.
void compare_bench(sim::Json& bench, const sim::Json& other);

/// Returns tables for a terminal: whole runs, then replays and samples, then the same compared, if there is `against`.
std::string bench_table(const sim::Json& bench);

/// Returns the median of at least one value.
inline double median(std::vector<double> values) {
  std::ranges::sort(values);
  return (values[(values.size() - 1) / 2] + values[values.size() / 2]) / 2;
}

}  // namespace tools
