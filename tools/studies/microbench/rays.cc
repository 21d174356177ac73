#include <deque>

#include <fmt/format.h>

#include "hw_models/machines/ray_source.h"
#include "hw_models/tni/tni.h"
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
      : clock_(config.clocks.tni.clock()),
        equal_{ray.walk()},
        rays_(config.direct_interface.depth, 1, clock_),
        hits_(config.direct_interface.depth, 1, clock_),
        source_(clock_, config.direct_interface.interval, equal_, rays_, hits_),
        tni_(config.tni, {.l1 = true}, {{}, {0, triangle_bytes}}, config.direct_interface.interval,
             memory_links(config.tni.trvs + 1), clock_) {
    wakes_.reset(3 + config.tni.trvs);
    std::vector<sim::Waker> trvs;
    for (std::uint32_t t = 0; t < config.tni.trvs; ++t) trvs.push_back(wakes_.of(3 + t));
    tni_.wakes(wakes_.of(1), wakes_.of(2), trvs);
    rays_.wakes(wakes_.of(0), wakes_.of(1));
    hits_.wakes(wakes_.of(1), wakes_.of(0));
  }

  /// Rays a cycle once the unit is full.
  double rays_per_cycle() {
    sim::run(*this);
    return steady_rate(equal_.hits) * static_cast<double>(clock_.period()) /
           static_cast<double>(sim::kFemtosecondsPerSecond);
  }

  // The machine, as the engine sees it.
  void each_unit(auto&& f) {
    f(source_, 0);
    f(tni_.dispatcher(), 1);
    f(tni_.ist(), 2);
    std::size_t i = 3;
    for (hw::Trv& trv : tni_.trvs()) f(trv, i++);
  }
  sim::Wakes& wakes() { return wakes_; }
  bool done() const { return source_.done(); }
  std::string state() const { return tni_.dispatcher().state() + "\n"; }

 private:
  /// Nothing ever goes over these.
  hw::Tni::Links memory_links(std::uint32_t ports) {
    hw::Tni::Links links{rays_, hits_, {}, {}};
    for (std::uint32_t p = 0; p < ports; ++p) {
      links.memory_out.push_back(&requests_.emplace_back(1, 1, clock_));
      links.memory_in.push_back(&lines_.emplace_back(1, 1, clock_));
    }
    return links;
  }

  const sim::Clock clock_;
  EqualRays equal_;
  sim::Link<hw::RayJob> rays_;
  sim::Link<hw::RayDone> hits_;
  std::deque<sim::Link<hw::MemRequest>> requests_;
  std::deque<sim::Link<hw::MemResponse>> lines_;
  hw::RaySource<EqualRays> source_;
  hw::Tni tni_;
  sim::Wakes wakes_;
};

Findings measure(const RunConfig& machine) {
  using enum traces::ExitPhase;
  hw::GpuConfig config = machine.gpu;
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
