#include <algorithm>
#include <numeric>

#include <gtest/gtest.h>

#include "tests/hw_models/tni/random_load.h"

namespace hw {
namespace {

using test::kWires;
using test::one_trv;
using test::random_setup;
using test::RandomLoad;
using test::TniHarness;
using test::Walk;
using traces::cull_step;
using traces::end_step;
using traces::leaf_step;
using traces::visit_step;

constexpr std::uint32_t kHit = 3, kEdge = 2, kDistance = 1;

/// Returns a traversal that visits nodes 0, 1, 2, ..., `n` - 1. Each visit hits one child; the last hits none.
Walk straight(std::uint32_t n) {
  Walk walk;
  for (std::uint32_t i = 0; i + 1 < n; ++i) walk.push_back(visit_step(i, 1, 0));
  walk.push_back(visit_step(n - 1, 0, 0));
  walk.push_back(end_step(false));
  return walk;
}

TEST(Tni, ASingleRayOfNHitsTakesWiresPlusNTimesFetchAndBox) {
  for (const std::uint32_t n : {1U, 2U, 7U, 40U}) {
    TniHarness harness(one_trv());
    harness.add(straight(n)).add(straight(n));  // the first ray loads the lines into the cache
    harness.run();
    // Each of the first ray's n misses costs the latency of memory and a second probe.
    const std::uint64_t visit = 2 + 12;
    const std::uint64_t miss = 1 + 50;
    EXPECT_EQ(harness.latency(0), kWires + n * (visit + miss)) << n;
  }
  // The same ray again, alone and with warm caches, after the others have left.
  TniHarness::Setup setup = one_trv();
  setup.config.trv.rays = 1;
  TniHarness harness(setup);
  harness.add(straight(10), 2).run();
  EXPECT_EQ(harness.gap(), kWires - 1 + 10 * 14);
}

TEST(Tni, AFullPipeTakesOneVisitACycle) {
  TniHarness::Setup setup = one_trv();
  setup.config.trv.rays = 64;
  setup.memory_latency = 1;
  TniHarness harness(setup);
  harness.add(straight(20), 2000).run();
  const Trv& trv = *harness.tni().trvs().front();
  EXPECT_EQ(trv.stats().visits, 40000U);
  EXPECT_GE(harness.span(), 40000U);
  EXPECT_LE(harness.span(), 40000U + 400);
}

TEST(Tni, TooFewRaysBoundVisitsToRaysPerLatency) {
  TniHarness::Setup setup = one_trv();
  setup.config.trv.rays = 7;
  setup.memory_latency = 1;
  TniHarness harness(setup);
  harness.add(straight(200), 70).run();
  EXPECT_NEAR(static_cast<double>(harness.span()), 70.0 * 200 * 14 / 7, 0.02 * 70 * 200 * 14 / 7);
}

TEST(Tni, APopCostsTheStackLatencyAndEachCulledEntryOnceMore) {
  const auto cycles = [](const Walk& walk) {
    TniHarness::Setup setup = one_trv();
    setup.config.trv.rays = 1;
    TniHarness harness(setup);
    harness.add(walk, 2).run();
    return harness.gap();
  };
  const Walk down = {visit_step(0, 1, 0), visit_step(1, 1, 0), visit_step(2, 0, 0), end_step(false)};
  const Walk popped = {visit_step(0, 3, 0), visit_step(1, 0, 0), visit_step(2, 0, 0), end_step(false)};
  const Walk culled = {visit_step(0, 3, 0), visit_step(1, 3, 0), visit_step(2, 0, 0), cull_step(2), end_step(false)};
  EXPECT_EQ(cycles(popped), cycles(down) + 2);
  EXPECT_EQ(cycles(culled), cycles(down) + 2 * 2);
}

TEST(Tni, ATriangleTestEndsAtThePhaseThatFails) {
  const auto cycles = [](std::uint32_t phases, std::uint32_t count) {
    TniHarness::Setup setup = one_trv();
    setup.config.trv.rays = 1;
    TniHarness harness(setup);
    harness.add(Walk{visit_step(0, 1, 0), leaf_step(0, count), phases, end_step(false)}, 2).run();
    return harness.gap();
  };
  const std::uint64_t distance = cycles(kDistance, 1);
  EXPECT_EQ(distance, kWires - 1 + 14 + 4 + 2 + 8 + 1);  // visit, leaf pipe, fetch, stage 8, link back
  EXPECT_EQ(cycles(kEdge, 1), distance + 8);
  EXPECT_EQ(cycles(kHit, 1), distance + 14);
  // Triangle 1 of 48 bytes straddles two lines: one more access, then it follows triangle 0 through the pipe.
  EXPECT_EQ(cycles(kDistance | kDistance << 4, 2), distance + 2);
  EXPECT_EQ(cycles(kHit | kDistance << 4, 2), distance + 14);
}

TEST(Tni, RaysToOneLineMergeIntoOneRequest) {
  TniHarness::Setup setup = one_trv();
  TniHarness harness(setup);
  harness.add(Walk{visit_step(5, 0, 0), end_step(false)}, 20).run();
  EXPECT_EQ(harness.lines_requested(), 1U);
}

TEST(Tni, AShortStackRestartsFromItsLinkAndVisitsThePathAgain) {
  // Traversal along the chain 0 -> 1 -> 2 -> 3 that pushes at each node. No entry is culled: all four far children are
  // popped.
  const Walk walk = {visit_step(0, 3, 0), visit_step(1, 3, 0), visit_step(2, 3, 0), visit_step(3, 3, 0),
                     visit_step(4, 0, 0), visit_step(5, 0, 0), visit_step(6, 0, 0), visit_step(7, 0, 0),
                     visit_step(8, 0, 0), end_step(false)};
  TniHarness::Setup setup = one_trv();
  setup.parents = {0, 0, 1, 2, 3, 3, 2, 1, 0};
  setup.config.trv.stack_entries = 2;
  TniHarness harness(setup);
  harness.add(walk).run();
  const Trv::Stats& s = harness.tni().trvs().front()->stats();
  // The stack entries of nodes 3 and 2 are popped. Those of 0 and 1 were dropped: a restart visits 0 and 1 again and
  // pushes both.
  EXPECT_EQ(s.restarts, 1U);
  EXPECT_EQ(s.restarted_visits, 2U);
  EXPECT_EQ(s.visits, 9U + 2U);
  EXPECT_EQ(s.pops, 4U);

  setup.config.trv.stack = StackScheme::kFull;
  TniHarness full(setup);
  full.add(walk).run();
  EXPECT_EQ(full.tni().trvs().front()->stats().visits, 9U);
  EXPECT_EQ(full.tni().trvs().front()->stats().restarts, 0U);
}

/// Returns one record per box. Records of some siblings are adjacent.
std::vector<std::array<std::uint32_t, 2>> single_boxes(const RandomLoad& load) {
  std::vector<std::array<std::uint32_t, 2>> boxes;
  for (std::uint32_t i = 0; i < load.parents.size(); ++i) boxes.push_back({1 + 3 * i % 1201, 2 + 2 * i});
  return boxes;
}

struct Fingerprint {
  std::vector<std::uint64_t> values;
  friend bool operator==(const Fingerprint&, const Fingerprint&) = default;
};

template <class Unit>
void append(Fingerprint& f, const Unit& unit) {
  const typename Unit::Stats& stats = unit.stats();
  Unit::Stats::describe(stats, [&](std::uint64_t v, auto&&...) { f.values.push_back(v); });
  for (std::size_t w = 0; w < static_cast<std::size_t>(Unit::CycleReason::kCount); ++w) {
    f.values.push_back(unit.activity().spent(static_cast<typename Unit::CycleReason>(w)));
  }
}

Fingerprint fingerprint(const TniHarness& harness) {
  Fingerprint f;
  f.values.push_back(harness.end_time());
  append(f, harness.tni().dispatcher());
  append(f, harness.tni().ist_of(0));
  for (const Trv* trv : harness.tni().trvs()) append(f, *trv);
  return f;
}

TEST(Tni, SkippingIdleTimeAndAnyUnitOrderGiveTheOraclesCounters) {
  for (std::uint64_t seed = 0; seed < 80; ++seed) {
    const RandomLoad load(seed, 400, 300, seed % 4 >= 2);
    TniHarness::Setup setup = random_setup(seed);
    load.give(setup);
    setup.single_boxes = seed % 2 == 0 ? single_boxes(load) : decltype(setup.single_boxes){};
    const auto fresh = [&] {
      auto harness = std::make_unique<TniHarness>(setup);
      load.send(*harness);
      return harness;
    };
    const Fingerprint fast = fingerprint(fresh()->run());
    EXPECT_EQ(fast, fingerprint(fresh()->run<sim::Skip::kOff>())) << "seed " << seed;
    EXPECT_EQ(fast, fingerprint(fresh()->run_shuffled(seed))) << "seed " << seed;
  }
}

TEST(Tni, AllRaysLeaveAndEveryCycleHasAReason) {
  for (std::uint64_t seed = 100; seed < 180; ++seed) {
    SCOPED_TRACE(seed);
    const RandomLoad load(seed, 400, 300, seed % 4 >= 2);
    TniHarness::Setup setup = random_setup(seed);
    load.give(setup);
    setup.single_boxes = seed % 2 == 0 ? single_boxes(load) : decltype(setup.single_boxes){};
    TniHarness harness(setup);
    load.send(harness).run();
    std::vector<std::uint32_t> ids = harness.arrived();
    std::ranges::sort(ids);
    std::vector<std::uint32_t> all(load.walks.size());
    std::iota(all.begin(), all.end(), 0U);
    EXPECT_EQ(ids, all);

    const Ist::Stats& ist = harness.tni().ist_of(0).stats();
    EXPECT_EQ(ist.leaves_in, ist.leaves_out);
    EXPECT_EQ(ist.l1_hits + ist.l1_misses, ist.l1_accesses);
    EXPECT_EQ(harness.tni().ist_of(0).activity().accounted_until(), harness.end_time());
    std::uint64_t leaves = 0, fills = ist.l1_fills;
    for (const Trv* trv : harness.tni().trvs()) {
      const Trv::Stats& s = trv->stats();
      EXPECT_EQ(s.rays_in, s.rays_out);
      EXPECT_EQ(s.l1_hits + s.l1_misses, s.l1_accesses);
      const bool one = setup.config.trv.box_testers == 1;
      EXPECT_EQ(s.first_passes, one ? s.visits : 0);
      EXPECT_GE(s.l1_hits + s.rau_reads + s.gathered, s.visits + s.first_passes);
      EXPECT_LE(s.l1_hits + s.rau_reads + s.gathered, (s.visits + s.first_passes) * (one ? 2 : 4));
      EXPECT_EQ(setup.hybrid ? s.hybrid_box_tests : s.box_tests, 2 * s.visits);
      EXPECT_EQ(setup.hybrid ? s.box_tests : s.hybrid_box_tests, 0U);
      EXPECT_EQ(s.pushes, s.pops + s.dropped);
      EXPECT_EQ(s.rau_writes, s.rau_reads);
      EXPECT_LE(s.prefetches_useful + s.prefetches_late + s.prefetches_useless, s.prefetches);
      EXPECT_LE(s.prefetches, s.prefetch_probes);
      EXPECT_LE(s.gathered, (setup.config.trv.gather_width - 1) * s.groups);
      EXPECT_EQ(trv->activity().accounted_until(), harness.end_time());
      sim::Time sum = 0;
      for (std::size_t w = 0; w < static_cast<std::size_t>(Trv::CycleReason::kCount); ++w) {
        sum += trv->activity().spent(static_cast<Trv::CycleReason>(w));
      }
      EXPECT_EQ(sum, harness.end_time());
      leaves += s.leaves;
      fills += s.l1_fills;
    }
    EXPECT_EQ(leaves, ist.leaves_in);
    EXPECT_EQ(fills, harness.lines_requested());
  }
}

}  // namespace
}  // namespace hw
