#include <fmt/format.h>

#include "tools/studies/microbench/benchmark.h"
#include "tools/studies/microbench/memory_forms.h"
#include "tools/studies/microbench/memory_side.h"

namespace tools {
namespace {

constexpr std::uint32_t kLines = 40'000;
constexpr std::uint32_t kLineBits = 22;  // address bits of the space that random lines come from

/// A different number below 2^kLineBits for each one: its bits folded and multiplied, twice.
std::uint32_t scattered(std::uint32_t i) {
  constexpr std::uint32_t kMask = (1U << kLineBits) - 1;
  for (const std::uint32_t odd : {0x2c1b3c6dU, 0x297a2d39U}) {
    i ^= i >> (kLineBits / 2);
    i = i * odd & kMask;
  }
  return i ^ i >> (kLineBits / 2);
}

/// All readers of all cores share a stream: each takes every so-many-th of its lines.
double measured_gbps(const hw::GpuConfig& config, bool random) {
  MemorySide side(config);
  const auto readers = static_cast<std::uint32_t>(side.readers().size());
  for (std::uint32_t i = 0; i < kLines / readers * readers; ++i)
    side.readers()[i % readers]->read((random ? scattered(i) : i) * config.l2.cache.line.bytes);
  side.run();
  std::vector<sim::Time> moments;
  for (const Reader* reader : side.readers()) {
    for (const Reader::Read& read : reader->reads()) moments.push_back(read.there);
  }
  return steady_rate(moments) * static_cast<double>(config.l2.cache.line.bytes) / 1e9;
}

Figure figure_of(const hw::GpuConfig& config, bool random) {
  const MemoryForms forms(config);
  const Level level = random ? Level::kBankClosed : Level::kRowOpen;
  const std::uint32_t mshrs = config.cores * (config.tni.trvs * config.tni.trv.l1.mshrs + config.tni.ist.l1.mshrs +
                                              config.srp.data_cache.mshrs);
  const UpperBound bound = least({forms.ports(config.cores), forms.l2_lines(), forms.l1_mshrs(mshrs, level),
                                  forms.l2_mshrs(level), random ? forms.lines_of_own_row() : forms.streamed()});
  return {fmt::format("{}, {}", config.dram.grade, random ? "random" : "stream"),
          "GB/s",
          measured_gbps(config, random),
          bound.value * static_cast<double>(config.l2.cache.line.bytes) / 1e9,
          Figure::Holds::kAtMost,
          std::string(bound.by)};
}

Findings measure(const JobOptions& job, bool all_grades) {
  std::vector<hw::GpuConfig> machines;
  if (!all_grades) machines.push_back(*real_machine(job).gpu);
  for (const JobOptions& of_grade : all_grades ? jobs_of_all_grades(job) : std::vector<JobOptions>{}) {
    machines.push_back(*real_machine(of_grade).gpu);
  }
  Findings found{"lines read through the L2", {}};
  for (const hw::GpuConfig& config : machines) {
    for (const bool random : {false, true}) found.figures.push_back(figure_of(config, random));
  }
  return found;
}

}  // namespace

Benchmark bandwidth_benchmark() {
  return {
      "bandwidth",
      "Lines a second that all cores together get from DRAM through the L2, streamed and at random",
      "Every first-level cache of every core asks for lines that no cache has, as fast as its miss registers allow.\n"
      "The bound is the tightest of what ports, caches, their miss registers and the DRAM let through; what queues,\n"
      "banks that wait, and refreshes cost comes off it.\n"
      "\n"
      "Example: raywatt microbench bandwidth --all-grades --set cores=8",
      {json_option(), {"--all-grades", "with each speed grade in configs/dram in turn", &BenchmarkJob::all_grades}},
      [](const BenchmarkJob& job) { return measure(job.machine, job.all_grades); }};
}

}  // namespace tools
