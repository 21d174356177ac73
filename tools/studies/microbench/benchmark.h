#pragma once
#include <cstdint>
#include <string>
#include <variant>
#include <vector>

#include "tools/run/frame/load_config.h"
#include "tools/studies/microbench/figure.h"

namespace tools {

/// The machine that is measured, and what else a benchmark may be told.
struct BenchmarkJob {
  JobOptions machine;
  bool json = false;
  std::string scene;
  std::string resolution = "64x32";
  bool all_grades = false;
  std::vector<std::string> kernels;
  std::string stream;
  std::uint32_t outstanding = 0;  ///< 0: as many as the read queue holds
  std::string refresh = "on";
};

/// An option of a benchmark on the command line.
struct BenchmarkOption {
  using Member = std::variant<bool BenchmarkJob::*, std::uint32_t BenchmarkJob::*, std::string BenchmarkJob::*,
                              std::vector<std::string> BenchmarkJob::*>;
  const char* name;
  const char* meaning;
  Member member;
  bool default_shown = false;
  std::vector<std::string> words{};  ///< that are allowed; none: any
  int most = 0;                      ///< a number is from 1 to this
};

/// A benchmark of `raywatt microbench`. All have --json among their options.
struct Benchmark {
  const char* name;
  const char* meaning;
  const char* footer;
  std::vector<BenchmarkOption> options;
  Findings (*measure)(const BenchmarkJob& job);
};

/// --json, as most benchmarks have it.
BenchmarkOption json_option();

/// The configured machine without ideal resources: what costs no time has no figure.
RunConfig real_machine(const JobOptions& job);
/// The job on each grade in configs/dram. InputError if it sets the grade itself.
std::vector<JobOptions> jobs_of_all_grades(const JobOptions& job);

/// Line after line once a unit is busy: the mean rate, per second, between the first tenth and the last of these
/// moments (in fs, in any order).
double steady_rate(std::vector<std::uint64_t> moments);

// Each benchmark measures a piece of the machine alone beside its closed form.
Benchmark chase_benchmark();
Benchmark bandwidth_benchmark();
Benchmark mshr_benchmark();
Benchmark dram_benchmark();
Benchmark rays_benchmark();
Benchmark early_exit_benchmark();
Benchmark tile_buffer_benchmark();
Benchmark kernels_benchmark();

}  // namespace tools
