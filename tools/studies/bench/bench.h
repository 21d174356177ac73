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
  JobOptions job;  ///< its threads are those of the whole run
  std::vector<std::string> scenes = {"cornell", "teapot"};
  std::uint32_t runs = 5;
  std::filesystem::path measured;  ///< figures saved before, taken instead of measuring; empty: none
  std::filesystem::path against;   ///< figures to compare with; empty: none
};

/// A figure of a scene: a key of the JSON, a column of a table.
struct BenchFigure {
  enum class Kind : std::uint8_t {
    kRate,   ///< per second, and more is better
    kTimes,  ///< more is better
    kCost,   ///< less is better
    kFact,   ///< that no build should be better at than another
  };
  std::string name, header;
  Kind kind = Kind::kRate;
  bool of_part = false;  ///< need not play the whole frame: a trace replayed, tiles sampled
};
const std::vector<BenchFigure>& bench_figures();

/// Measures scene after scene, each in a process of its own, as peak memory never falls: schema raywatt-bench/2. Each
/// figure is a median over `runs` rounds, and a round measures everything in turn. If a scene's process fails, which
/// has said why, this one ends with its exit code. So it does, before it measures, if a scene's figures could not be
/// compared with those of `other`, if that is given.
sim::Json measure_scenes(const BenchOptions& options, const sim::Json* other = nullptr);

/// Reads what `raywatt bench --json` has printed; of several results of one kind, one behind the other, the medians.
/// InputError.
sim::Json load_bench(const std::filesystem::path& file);

/// InputError that says what differs if figures of scenes that both have are of different frames, machines or threads;
/// and with `need_one` if there is no such scene. What one of them does not say, being of an older build, may be
/// anything. `file`: of `other`.
void check_comparable(const sim::Json& bench, const sim::Json& other, const std::filesystem::path& file,
                      bool need_one = true);

/// Adds to each scene of `bench` that `other` has, too, `against`: how many times as good each figure is.
void compare_bench(sim::Json& bench, const sim::Json& other);

/// Tables for a terminal: whole runs, then replays and samples; as many again if there is something to compare.
std::string bench_table(const sim::Json& bench);

/// The median of at least one value; for an even number the mean of the two in the middle.
inline double median(std::vector<double> values) {
  std::ranges::sort(values);
  return (values[(values.size() - 1) / 2] + values[values.size() / 2]) / 2;
}

}  // namespace tools
