#include "tools/studies/microbench/benchmark.h"

#include <algorithm>
#include <cstddef>

#include <fmt/format.h>

#include "hw_models/machines/gpu_config.h"
#include "sim/error.h"
#include "sim/io/printable.h"
#include "sim/time.h"
#include "tools/host/paths.h"

namespace tools {

BenchmarkOption json_option() { return {"--json", "as JSON", &BenchmarkJob::json}; }

RunConfig real_machine(const JobOptions& job) {
  RunConfig config = load_run_config(job);
  config.gpu->ideal = {};
  return config;
}

std::vector<JobOptions> jobs_of_all_grades(const JobOptions& job) {
  for (const std::string& set : job.sets) {
    if (!set.starts_with("dram.extends=")) continue;
    throw sim::InputError(
        fmt::format("--all-grades does not go with --set {}; allowed: one of them", sim::printable(set)));
  }
  std::vector<JobOptions> jobs;
  for (const std::string& grade : config_names_in("dram")) {
    JobOptions of_grade = job;
    of_grade.sets.insert(of_grade.sets.begin(), "dram.extends=" + grade);
    jobs.push_back(std::move(of_grade));
  }
  return jobs;
}

double steady_rate(std::vector<std::uint64_t> moments) {
  std::ranges::sort(moments);
  const std::size_t first = moments.size() / 10, last = moments.size() - 1 - first;
  return static_cast<double>(last - first) / static_cast<double>(moments[last] - moments[first]) *
         static_cast<double>(sim::kFemtosecondsPerSecond);
}

}  // namespace tools
