#include <vector>

#include <fmt/format.h>

#include "hw_models/machines/ray_machine.h"
#include "sim/engine.h"
#include "tools/studies/microbench/benchmark.h"
#include "tools/studies/microbench/tni_forms.h"

namespace tools {
namespace {

constexpr std::uint32_t kRays = 12'000;

/// Equal rays, and when they come back.
struct EqualRays {
  std::vector<std::uint32_t> steps;
  std::vector<sim::Time> hits{};
  std::uint32_t count() const { return kRays; }
  const std::uint32_t* walk(std::uint32_t) const { return steps.data(); }
  void returned(std::uint32_t, sim::Time now) { hits.push_back(now); }
};

/// A T&I unit with every line in its caches, between the two halves of its interface.
class TniStand {
 public:
  TniStand(const hw::GpuConfig& config, std::uint32_t triangle_bytes, const StraightRay& ray)
      : clock_(config.clocks.tni.clock()), equal_{ray.walk()} {
    const sim::UnitId source = machine_.unit({"rays", clock_});
    hw::TniCore tni(machine_, config.tni, {.l1 = true}, 0, clock_);
    std::vector<hw::MemoryPort> memory;  // nothing ever goes there
    for (const hw::MemoryClient& client : tni.memory_clients()) {
      memory.push_back({machine_.link<hw::MemRequest>(1, 1, client.unit, client.unit),
                        machine_.link<hw::MemResponse>(1, 1, client.unit, client.unit)});
    }
    source_ = &hw::build_source_and_tni(machine_, config.direct_interface, source, equal_, tni,
                                        {{}, {0, triangle_bytes}}, memory);
  }

  /// Rays a cycle once the unit is full.
  double rays_per_cycle() {
    sim::run(*this);
    return steady_rate(equal_.hits) * static_cast<double>(clock_.period()) /
           static_cast<double>(sim::kFemtosecondsPerSecond);
  }

  // As the engine sees it.
  sim::Machine& machine() { return machine_; }
  bool done() const { return source_->done(); }

 private:
  const sim::Clock clock_;
  EqualRays equal_;
  sim::Machine machine_;
  hw::RaySource<EqualRays>* source_ = nullptr;
};

Findings measure(const RunConfig& machine) {
  using enum traces::ExitPhase;
  hw::GpuConfig config = *machine.gpu;
  config.tni.trv.prefetch = hw::Prefetch::kNone;
  Findings found{"rays through one T&I unit", {}};
  const StraightRay misses{.visits = 4, .leaf = {}}, hits{.visits = 16, .leaf = {0, {kDistance, kHit}}};
  for (const std::uint32_t testers : {2U, 1U}) {
    for (const StraightRay& ray : {hits, misses}) {
      for (const std::uint32_t trvs : {1U, 2U, 4U, 8U}) {
        config.tni.trvs = trvs;
        config.tni.trv.box_testers = testers;
        const UpperBound bound = TniForms(config, machine.bvh.triangle_bytes).rays_per_cycle(ray);
        found.figures.push_back(
            {fmt::format("{} TRV{}, {} box tester{}, {} nodes{}", trvs, trvs == 1 ? "" : "s", testers,
                         testers == 1 ? "" : "s", ray.visits, ray.leaf.exits.empty() ? "" : " and 2 triangles"),
             "rays/cycle", TniStand(config, machine.bvh.triangle_bytes, ray).rays_per_cycle(), bound.value,
             bound.holds(), std::string(bound.by)});
      }
    }
  }
  return found;
}

}  // namespace

Benchmark rays_benchmark() {
  return {"rays",
          "Rays a cycle of one T&I unit with 1, 2, 4 and 8 traversal units, all lines in its caches",
          "Equal rays, which go straight down a tree. What sets the bound: traversal pipes, how many rays or\n"
          "leaves are inside at once, the intersection unit's triangle lines, or the direct interface.\n"
          "\n"
          "Example: raywatt microbench rays --set tni.trv.rays=16",
          {json_option()},
          [](const BenchmarkJob& job) { return measure(real_machine(job.machine)); }};
}

}  // namespace tools
