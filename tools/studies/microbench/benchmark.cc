#include "tools/studies/microbench/benchmark.h"

#include <algorithm>
#include <cstddef>

#include "sim/time.h"

namespace tools {

BenchmarkOption json_option() { return {"--json", "as JSON", &BenchmarkJob::json}; }

RunConfig real_machine(const JobOptions& job) {
  RunConfig config = load_run_config(job);
  config.gpu.ideal = {};
  return config;
}

double steady_rate(std::vector<std::uint64_t> moments) {
  std::ranges::sort(moments);
  const std::size_t first = moments.size() / 10, last = moments.size() - 1 - first;
  return static_cast<double>(last - first) / static_cast<double>(moments[last] - moments[first]) *
         static_cast<double>(sim::kFemtosecondsPerSecond);
}

}  // namespace tools
