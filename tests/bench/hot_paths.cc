// Benchmarks of the simulator's hot paths. Build: ninja -C build/release bench_units. Run:
// build/release/tests/bench_units
#include <string>
#include <vector>

#include <benchmark/benchmark.h>
#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "hw_models/dram/dram_channel.h"
#include "hw_models/dram/dram_measurements.h"
#include "hw_models/memory/cache.h"
#include "sim/config/config.h"
#include "sim/hash.h"
#include "sim/link.h"
#include "tests/hw_models/tni/harness.h"
#include "traces/accel/build.h"
#include "traces/accel/bvh_tracer.h"
#include "traces/scenes/library.h"
#include "traces/walk.h"

namespace {

void link_push_and_pop(benchmark::State& state) {
  const sim::Clock clock(2'000'000);
  sim::Link<std::uint64_t> link(4, 1, clock);
  sim::Time now = 0;
  for (auto _ : state) {
    link.push(now, now);
    now = clock.edge_after(now, 1);
    benchmark::DoNotOptimize(link.pop(now));
    now = clock.edge_after(now, 1);
  }
}
BENCHMARK(link_push_and_pop);

void cache_probe(benchmark::State& state) {
  hw::CacheTags tags{hw::CacheConfig{}};
  std::uint64_t n = 0;
  for (auto _ : state) {
    const hw::Addr line = sim::mix_bits(n++) % 512 * 64;
    if (!tags.probe(line)) tags.fill_line(line);
  }
}
BENCHMARK(cache_probe);

/// Measures host time per node visit in a T&I unit that is full of rays and whose caches hit.
void traversal_unit_visit(benchmark::State& state) {
  std::vector<std::uint32_t> walk;
  for (std::uint32_t node = 0; node < 30; ++node) walk.push_back(traces::visit_step(node, node == 29 ? 0 : 1, 0));
  walk.push_back(traces::end_step(false));
  constexpr std::uint32_t kRays = 2000;
  for (auto _ : state) {
    hw::test::TniHarness bench(hw::test::TniHarness::Setup{});
    bench.add(walk, kRays).run();
    benchmark::DoNotOptimize(bench.end_time());
  }
  state.SetItemsProcessed(state.iterations() * kRays * 30);
}
BENCHMARK(traversal_unit_visit);

/// Measures host time of one LPDDR4 channel under full load: consecutive lines (0) or random lines (1).
void dram_request(benchmark::State& state) {
  constexpr std::uint32_t kRequests = 20'000;
  for (auto _ : state) {
    const hw::DramConfig config;
    const sim::Clock clock(config.timing.ck.time);
    sim::Link<hw::MemRequest> in(8, 1, clock);
    sim::Link<hw::MemResponse> out(64, 1, clock);
    hw::DramChannel channel(config, {{&in}, {&out}});
    sim::Time now = 0, wake = 0;
    in.set_wakeup_handles(nullptr, &wake);
    out.set_wakeup_handles(&wake, nullptr);
    std::uint32_t sent = 0, received = 0;
    while (received < kRequests) {
      while (sent < kRequests && in.can_push(now)) {
        const std::uint64_t line = state.range(0) == 0 ? sent : sim::mix_bits(sent) % (1 << 20);
        in.push(now, hw::MemRequest{line * 64 * config.channels, 0, 0, false});
        ++sent;
      }
      for (; out.can_pop(now); ++received) out.pop(now);
      if (wake <= now) {
        wake = sim::kNever;
        wake = std::min(wake, channel.tick(now));
      }
      const sim::Time feed = sent < kRequests ? std::max(clock.edge_after(now, 1), in.push_at()) : sim::kNever;
      now =
          std::min({std::max(clock.edge_after(now, 1), wake), feed, std::max(clock.edge_after(now, 1), out.pop_at())});
    }
  }
  state.SetItemsProcessed(state.iterations() * kRequests);
}
BENCHMARK(dram_request)->Arg(0)->Arg(1);

/// Measures host time of a DRAM grade's model as run by `raywatt microbench dram`. Arguments: stream (0) or random
/// lines (1), and percentage of reads. Run it in the folder that contains configs/.
void dram_play(benchmark::State& state, const char* grade) {
  const auto config = sim::load_config<hw::DramConfig>(std::string("configs/dram/") + grade + ".yaml");
  std::vector<hw::DramRequest> requests;
  for (std::uint64_t i = 0; i < 100'000; ++i) {
    const std::uint64_t line = state.range(0) == 0 ? i : sim::mix_bits(i) % (1 << 24);
    requests.push_back({line * 64, sim::hash(i) % 100 >= static_cast<std::uint64_t>(state.range(1)), 0});
  }
  for (auto _ : state) benchmark::DoNotOptimize(hw::run_dram_requests(config, requests, 32).end);
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(requests.size()));
}
BENCHMARK_CAPTURE(dram_play, lpddr4, "lpddr4-3200")->Args({0, 100})->Args({0, 80})->Args({1, 100})->Args({1, 80});
BENCHMARK_CAPTURE(dram_play, lpddr5, "lpddr5-6400")->Args({0, 100})->Args({0, 80})->Args({1, 100})->Args({1, 80});

/// Measures host time of nearest-hit rays through the built-in conference room. Arguments: width, and number of the
/// node format in traces::NodeFormat.
void functional_ray(benchmark::State& state) {
  static const traces::Scene scene = traces::open_scene("conference");
  const traces::MemoryImage image =
      traces::build_memory_image(scene, {.leaf_size = 3,
                                         .width = static_cast<std::uint32_t>(state.range(0)),
                                         .format = static_cast<traces::NodeFormat>(state.range(1))});
  std::vector<traces::Ray> rays(4096);
  const auto point = [&](std::uint64_t seed) {
    glm::vec3 p;
    for (int a = 0; a < 3; ++a) {
      p[a] = glm::mix(image.lower[a], image.upper[a],
                      sim::hash_to_unit_float(sim::hash(seed, static_cast<std::uint64_t>(a))));
    }
    return p;
  };
  for (std::size_t i = 0; i < rays.size(); ++i) {
    rays[i].origin = point(2 * i);
    rays[i].direction = glm::normalize(point(2 * i + 1) - rays[i].origin);
  }
  std::vector<traces::Hit> hits(rays.size());
  std::vector<std::uint32_t> words, begin;
  const traces::BvhTracer tracer(image);
  for (auto _ : state) {
    words.clear();
    begin.clear();
    traces::WalkSink sink{words, begin};
    tracer.trace(rays, traces::RayKind::kPrimary, hits, &sink);
  }
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(rays.size()));
}
BENCHMARK(functional_ray)
    ->Args({2, 0})
    ->Args({4, 0})
    ->Args({6, 0})
    ->Args({8, 0})
    ->Args({8, 2})
    ->Args({8, 3})
    ->Args({8, 4});

}  // namespace

BENCHMARK_MAIN();
