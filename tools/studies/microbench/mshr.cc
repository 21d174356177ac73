#include <fmt/format.h>

#include "tools/studies/microbench/benchmark.h"
#include "tools/studies/microbench/memory_forms.h"
#include "tools/studies/microbench/memory_side.h"

namespace tools {
namespace {

constexpr std::uint32_t kMissedLines = 8000;
constexpr sim::Time kWarm = sim::kFemtosecondsPerSecond;  // when measurement begins, the L2 being warm

/// A traversal unit's cache alone reads lines that it has not, as fast as it can.
double measured_rate(const hw::GpuConfig& config, bool in_l2) {
  MemorySide side(config);
  const std::uint64_t line = config.l2.cache.line.bytes;
  for (std::uint64_t i = 0; i < kMissedLines; ++i) {
    if (in_l2) side.reader(0, config.tni.trvs).read(i * line);
    side.reader(0, 0).read(i * line, in_l2 ? kWarm : 0);
  }
  side.run();
  std::vector<sim::Time> moments;
  for (const Reader::Read& read : side.reader(0, 0).reads()) moments.push_back(read.there);
  return steady_rate(moments) / 1e6;
}

Findings measure(hw::GpuConfig config) {
  config.cores = 1;
  config.dram.timing.refi_pb = config.dram.timing.refi_ab = 0;
  config.dram.controller.power_down = false;
  config.dram.controller.page_policy = hw::PagePolicy::kOpen;
  while (config.l2.cache.size.bytes < 2 * kMissedLines * config.l2.cache.line.bytes) config.l2.cache.size.bytes *= 2;
  const MemoryForms forms(config);
  Findings found{"misses of one L1", {}};
  for (const bool in_l2 : {true, false}) {
    for (std::uint32_t mshrs = 1; mshrs <= 64; mshrs *= 2) {
      config.tni.trv.l1.mshrs = mshrs;
      const Level level = in_l2 ? Level::kL2 : Level::kRowOpen;
      std::vector<UpperBound> bounds = {forms.l1_mshrs(mshrs, level), forms.ports(1), forms.l2_lines(),
                                        forms.request_wire()};
      if (!in_l2) {
        bounds.push_back(forms.l2_mshrs(level));
        bounds.push_back(forms.streamed());
      }
      const UpperBound bound = least(bounds);
      found.figures.push_back(
          {fmt::format("{} miss register{}, lines in {}", mshrs, mshrs == 1 ? "" : "s", in_l2 ? "the L2" : "DRAM"),
           "M/s", measured_rate(config, in_l2), bound.value / 1e6, in_l2 ? bound.holds() : Figure::Holds::kAtMost,
           std::string(bound.by)});
    }
  }
  return found;
}

}  // namespace

Benchmark mshr_benchmark() {
  return {"mshr",
          "Misses a second of one first-level cache, by its number of miss registers",
          "One traversal unit's cache misses as fast as it can; all else rests. Lines that the L2 has come after\n"
          "the same time each, so the closed form holds; lines in DRAM now and then open a row, which the form\n"
          "leaves out. There are no refreshes and no power-down, and the L2 is large enough.\n"
          "\n"
          "Example: raywatt microbench mshr --set l2.hit_cycles=40",
          {json_option()},
          [](const BenchmarkJob& job) { return measure(*real_machine(job.machine).gpu); }};
}

}  // namespace tools
