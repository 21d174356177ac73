#pragma once
#include <cstdint>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "hw_models/dram/dram_measurements.h"
#include "tools/run/frame/load_config.h"

namespace tools {

/// A value measured by simulating a part of the machine, and the value that a formula predicts.
struct Measurement {
  /// The relation between measured and expected value that a microbenchmark checks.
  enum class Relation : std::uint8_t {
    kExactly,
    kClosely,  ///< both values differ by at most 2 %
    kNearly,   ///< the measured value is 90 % to 100 % of the expected one
    kAtMost,   ///< the expected value is an upper bound, with 2 % tolerance for the start and end of the run
    kAtLeast,  ///< the expected value is a lower bound
  };
  std::string name;
  std::string unit;
  double measured = 0;
  double expected = 0;
  Relation holds = Relation::kExactly;
  std::string remark{};  ///< text after the values, e.g. the bottleneck

  bool is_good() const;
  /// Returns the difference of measured and expected value, divided by the expected value; 0 if both are equal.
  double relative_error() const;
};

/// Results of a microbenchmark, and how to print them.
struct Findings {
  std::string title;
  std::vector<Measurement> measurements;
  std::vector<std::string> notes{};  ///< printed below the table
  std::string table{};               ///< printed instead of the table of all measurements; may be empty
  std::string printed{};             ///< printed instead of all other output; may be empty

  bool is_good() const;
};

/// An upper bound of a rate, and the bottleneck that causes it.
struct UpperBound {
  double value = 0;
  std::string_view by;
  bool reached = true;  ///< false: waiting, which the formula ignores, keeps the rate below the bound

  /// Returns the relation that a measurement must have to the bound.
  Measurement::Relation required_relation() const {
    return reached ? Measurement::Relation::kClosely : Measurement::Relation::kAtMost;
  }
};
/// Returns the smallest upper bound of a rate. It is marked as not reached if one of up to 1.5 times its value is not.
UpperBound tightest_bound(const std::vector<UpperBound>& bounds);

std::string findings_table(const Findings& findings);
/// Returns the findings as JSON, schema raywatt-microbench/1.
std::string findings_json(std::string_view benchmark, const Findings& findings);

/// The machine that a microbenchmark simulates, and the benchmark's options.
struct BenchmarkJob {
  JobOptions machine;
  bool json = false;
  std::string scene;
  std::string resolution = "64x32";
  bool all_grades = false;
  std::vector<std::string> kernels;
  std::string stream;
  std::uint32_t outstanding = 0;  ///< reads in flight; 0: size of the read queue
  std::string refresh = "on";
};

/// A command-line option of one microbenchmark.
struct BenchmarkOption {
  using Member = std::variant<bool BenchmarkJob::*, std::uint32_t BenchmarkJob::*, std::string BenchmarkJob::*,
                              std::vector<std::string> BenchmarkJob::*>;
  const char* name;
  const char* meaning;
  Member member;
  bool default_shown = false;
  std::vector<std::string> words{};  ///< allowed values; empty: any text
  int most = 0;                      ///< largest number; the smallest is 1
};

/// A microbenchmark of `raywatt microbench`, with its own options. All benchmarks also have the option --json.
struct Benchmark {
  const char* name;
  const char* meaning;
  const char* footer;
  std::vector<BenchmarkOption> options;
  Findings (*measure)(const BenchmarkJob& job);
};

/// Returns the option --json, which every microbenchmark has.
BenchmarkOption json_option();

/// Returns the configuration of the machine with all `ideal` settings switched off.
RunConfig non_ideal_machine(const JobOptions& job);
/// Returns one copy of the job for each DRAM grade in configs/dram. Throws InputError if the job sets the grade.
std::vector<JobOptions> jobs_with_all_dram_grades(const JobOptions& job);

/// Returns the mean rate of events per second, leaving out the first and the last tenth of the events. `moments`: times
/// of the events in fs, in any order.
double steady_rate(std::vector<std::uint64_t> moments);

// Each microbenchmark simulates one part of the machine and compares measured values with formulas.
Benchmark chase_benchmark();
Benchmark bandwidth_benchmark();
Benchmark mshr_benchmark();
Benchmark dram_benchmark();
Benchmark rays_benchmark();
Benchmark early_exit_benchmark();
Benchmark tile_buffer_benchmark();
Benchmark kernels_benchmark();

/// Reads DRAM requests from a text file, or from standard input if `file` is "-". A line has a hexadecimal address, R
/// (read) or W (write), and optionally the earliest time of the request in ns. Empty lines and # comments are ignored.
/// Throws InputError with file and line.
std::vector<hw::DramRequest> load_dram_stream(const std::string& file);

}  // namespace tools
