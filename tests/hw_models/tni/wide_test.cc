#include <algorithm>
#include <array>
#include <initializer_list>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "sim/error.h"
#include "tests/hw_models/tni/wide_load.h"

// Tests of traversal units with wide nodes: passes, lines, latencies, stacks, restarts, and intersection units.

namespace hw {
namespace {

using test::alone;
using test::kPop;
using test::one_trv;
using test::TniHarness;
using test::trv;
using test::Walk;
using test::wide_visit;
using test::WideLoad;
using traces::end_step;
using traces::leaf_step;

/// Cycles of a wide visit that takes one pass: fetch 2, box test 12, ordering 3; decoding takes 2 more.
constexpr std::uint64_t kWideVisit = 17, kDecode = 2;

/// Returns a setup with wide nodes of `children` children and `lines` lines each. Node n has the inner children
/// n * children + 1 and following.
TniHarness::Setup wide_trv(std::uint32_t children, std::uint32_t testers, std::uint32_t lines = 1,
                           std::uint32_t nodes = 100) {
  TniHarness::Setup s = one_trv();
  s.kind = {.wide = true, .format = traces::NodeFormat::kQ8, .slots = 8};
  s.config.trv.box_testers = testers;
  s.config.trv.stack = StackScheme::kFull;
  for (std::uint32_t n = 0; n < nodes; ++n) {
    s.wide.push_back({n * lines, static_cast<std::uint8_t>(lines), static_cast<std::uint8_t>(children)});
    traces::WideNode& node = s.wide_links.emplace_back();
    std::ranges::fill(node.child, traces::kNoChild);
    for (std::uint32_t c = 0; c < children; ++c) node.child[c] = n * children + 1 + c;
    s.parents.push_back(n == 0 ? 0 : (n - 1) / children);
  }
  return s;
}

Walk joined(std::initializer_list<std::array<std::uint32_t, 2>> visits, const Walk& rest = {end_step(false)}) {
  Walk walk;
  for (const auto& words : visits) walk.insert(walk.end(), words.begin(), words.end());
  walk.insert(walk.end(), rest.begin(), rest.end());
  walk.resize(walk.size() + 16, end_step(false));
  return walk;
}

std::string counters_of(TniHarness& harness) {
  std::string all;
  for (const sim::UnitReport& unit : harness.machine().report()) {
    all += unit.path;
    for (const auto& [reason, cycles] : unit.cycles_by_reason) all += fmt::format(" {}={}", reason, cycles);
    for (const sim::CounterReport& c : unit.counters) all += fmt::format(" {}={}", c.name, c.value);
    all += "\n";
  }
  return all;
}

TEST(WideVisit, OfALoneRayTakesOnePassMoreForEachRoundOfTesters) {
  const Walk down = joined({wide_visit(0, {2}), wide_visit(3, {})});
  for (const std::uint32_t children : {2U, 5U, 8U}) {
    for (const std::uint32_t testers : {2U, 3U, 4U, 8U}) {
      const std::uint64_t passes = (children + testers - 1) / testers;
      EXPECT_EQ(alone(wide_trv(children, testers), down), 2 * (kWideVisit + kDecode + passes - 1))
          << children << " children, " << testers << " testers";
    }
  }
}

TEST(WideVisit, ReadsARecordOfSeveralLinesLineByLine) {
  const Walk down = joined({wide_visit(0, {2}), wide_visit(3, {})});
  for (const std::uint32_t lines : {1U, 2U, 4U}) {
    TniHarness::Setup setup = wide_trv(8, 8, lines);
    EXPECT_EQ(alone(setup, down), 2 * (kWideVisit + kDecode + lines - 1)) << lines;
  }
}

TEST(WideVisit, LatencyDependsOnFormatAndOrder) {
  const Walk down = joined({wide_visit(0, {2}), wide_visit(3, {})});
  TniHarness::Setup setup = wide_trv(8, 8);
  setup.kind.format = traces::NodeFormat::kFp32;
  EXPECT_EQ(alone(setup, down), 2 * kWideVisit);
  setup.kind.format = traces::NodeFormat::kCw80;
  setup.kind.order = traces::ChildOrder::kOctant;
  EXPECT_EQ(alone(setup, down), 2 * (kWideVisit + kDecode - 3));
  setup.config.trv.decode_latency = 7;
  EXPECT_EQ(alone(setup, down), 2 * (kWideVisit + 7 - 3));
}

/// Returns the cycles per visit of a unit that is full of rays, with all lines in its L1.
double cycles_per_visit(std::uint32_t children, std::uint32_t testers, std::uint32_t lines) {
  constexpr std::uint32_t kRays = 2000;
  TniHarness::Setup setup = wide_trv(children, testers, lines);
  setup.config.trv.rays = 64;
  setup.ideal.l1 = true;
  TniHarness harness(setup);
  harness.add(joined({wide_visit(0, {0}), wide_visit(1, {1}), wide_visit(10, {})}), kRays).run();
  const Trv::Stats stats = trv(harness).stats();
  EXPECT_EQ(stats.visits, 3 * kRays);
  EXPECT_EQ(stats.node_lines, 3 * kRays * lines);
  EXPECT_EQ(stats.q8_box_tests, std::uint64_t{3} * kRays * children);
  return static_cast<double>(harness.span()) / (3.0 * kRays);
}

TEST(WideVisit, AFullPipeStartsOneVisitPerRoundOfTestersOrPerLineOfTheRecord) {
  EXPECT_NEAR(cycles_per_visit(8, 8, 1), 1, 0.03);
  EXPECT_NEAR(cycles_per_visit(8, 4, 1), 2, 0.03) << "width 8 with 4 testers";
  EXPECT_NEAR(cycles_per_visit(5, 4, 1), 2, 0.03);
  EXPECT_NEAR(cycles_per_visit(8, 3, 1), 3, 0.03);
  EXPECT_NEAR(cycles_per_visit(4, 4, 2), 2, 0.03) << "two lines";
  EXPECT_NEAR(cycles_per_visit(8, 4, 2), 2, 0.15) << "the second pass hides the next visit's first line";
  EXPECT_NEAR(cycles_per_visit(8, 2, 4), 4, 0.15);
  EXPECT_NEAR(cycles_per_visit(8, 1, 1), 8, 0.1) << "one tester and one pipe";
}

TEST(WideVisit, CountsTheWorkOfTestersDecoderAndComparators) {
  TniHarness::Setup setup = wide_trv(5, 4);
  const auto stats_of = [&](auto&& change) {
    change(setup);
    TniHarness harness(setup);
    harness.add(joined({wide_visit(0, {4, 1}), wide_visit(5, {}), wide_visit(2, {})}), 7).run();
    return trv(harness).stats();
  };
  Trv::Stats stats = stats_of([](TniHarness::Setup&) {});
  EXPECT_EQ(stats.visits, 21U);
  EXPECT_EQ(stats.q8_box_tests, 21U * 5);
  EXPECT_EQ(stats.box_tests + stats.hybrid_box_tests + stats.q12_box_tests, 0U);
  EXPECT_EQ(stats.idle_lanes, 21U * 3);
  EXPECT_EQ(stats.clocked_lanes, 0U);
  EXPECT_EQ(stats.decoded_nodes, 21U);
  EXPECT_EQ(stats.comparisons, 21U * 9) << "the smallest sorting network of five inputs";
  EXPECT_EQ(stats.pushes, 7U);
  EXPECT_EQ(stats.pops, 7U);
  stats = stats_of([](TniHarness::Setup& s) {
    s.kind.format = traces::NodeFormat::kQ12;
    s.kind.order = traces::ChildOrder::kNearest;
    s.config.trv.idle_testers = IdleTesters::kClocked;
  });
  EXPECT_EQ(stats.q12_box_tests, 21U * 5);
  EXPECT_EQ(stats.comparisons, 21U * 4);
  EXPECT_EQ(stats.clocked_lanes, 21U * 3);
  stats = stats_of([](TniHarness::Setup& s) {
    s.kind.format = traces::NodeFormat::kFp32;
    s.kind.order = traces::ChildOrder::kOctant;
  });
  EXPECT_EQ(stats.box_tests, 21U * 5);
  EXPECT_EQ(stats.comparisons + stats.decoded_nodes, 0U);
}

TEST(WideVisit, RefusesPipesThatAreTooLong) {
  TniHarness::Setup setup = wide_trv(8, 1);
  setup.config.trv.box_latency = 40;
  setup.config.trv.decode_latency = setup.config.trv.order_latency = 8;
  try {
    const TniHarness harness(setup);
    FAIL() << "accepted";
  } catch (const sim::InputError& error) {
    EXPECT_EQ(
        std::string(error.what()),
        "tni.trv.box_latency: node fetch, decoding, box tests and ordering of a node take 65 cycles; allowed: 1 to "
        "63");
  }
}

TEST(WideStack, CountsBalanceOnRandomTreesWithAFullStack) {
  for (const std::uint32_t width : {2U, 4U, 6U, 8U}) {
    for (const bool levels : {false, true}) {
      const WideLoad load(width, width, 120, 200, levels);
      TniHarness::Setup setup = one_trv();
      setup.config.trv.box_testers = 4;
      setup.config.trv.stack = StackScheme::kFull;
      load.give(setup);
      setup.wide_links = load.nodes;
      TniHarness harness(setup);
      load.send(harness).run();
      const Trv::Stats stats = trv(harness).stats();
      const WideLoad::Counts& n = load.counts;
      EXPECT_EQ(stats.visits, n.visits);
      EXPECT_EQ(stats.box_tests, n.children);
      EXPECT_EQ(stats.leaves, n.leaves);
      EXPECT_EQ(stats.transforms, n.enters);
      EXPECT_EQ(stats.pushes, stats.pops + n.dropped);
      // Each ray visits one root without a hit before. A hit child that is an instance leads to one more visit.
      EXPECT_EQ(n.hits, (stats.visits - load.walks.size()) + stats.leaves + n.culled + n.dropped);
      EXPECT_EQ(stats.node_lines, stats.visits) << "bytes are 64 for each visit";
    }
  }
}

TEST(WideStack, AShortStackOfAnySchemeRestartsAndLosesNothing) {
  for (const StackScheme scheme : {StackScheme::kRestartLink, StackScheme::kRestartTrail, StackScheme::kParent}) {
    for (const StackPush push : {StackPush::kChild, StackPush::kNode}) {
      for (const std::uint32_t entries : {0U, 1U, 5U, 8U}) {
        if (entries == 0 && scheme == StackScheme::kRestartLink) continue;
        for (const bool levels : {false, true}) {
          SCOPED_TRACE(fmt::format("scheme {}, push {}, {} entries, levels {}", static_cast<int>(scheme),
                                   static_cast<int>(push), entries, levels));
          const WideLoad load(17, 8, 120, 200, levels);
          TniHarness::Setup setup = one_trv();
          setup.config.trv.stack = scheme;
          setup.config.trv.stack_push = push;
          setup.config.trv.stack_entries = entries;
          load.give(setup, 2);
          TniHarness harness(setup);
          load.send(harness).run();
          const Trv::Stats stats = trv(harness).stats();
          const WideLoad::Counts& n = load.counts;
          const std::uint64_t culls = push == StackPush::kNode ? n.culled : 0;
          EXPECT_EQ(stats.visits - stats.restarted_visits - stats.extra_visits, n.visits);
          EXPECT_EQ(stats.leaves - stats.extra_leaves, n.leaves);
          EXPECT_EQ(stats.extra_visits + stats.extra_leaves, culls) << "each culled child is visited nevertheless";
          EXPECT_GE(stats.pushes, stats.pops - stats.entry_updates + stats.dropped);
          if (entries < 5) {
            EXPECT_GT(stats.restarts, 0U);
          }
          EXPECT_EQ(stats.parent_links, scheme == StackScheme::kParent ? stats.restarted_visits : 0);
        }
      }
    }
  }
}

TEST(WideStack, ARestartTrailVisitsThePathFromTheRootAndParentLinksTheWayUp) {
  // The ray goes down from node 0 by 1 to 9, where nothing is hit. One other child of node 0 remains, 2.
  const Walk walk = joined({wide_visit(0, {0, 1}), wide_visit(1, {0}), wide_visit(9, {}), wide_visit(2, {})});
  TniHarness::Setup setup = wide_trv(8, 8);
  setup.config.trv.stack_entries = 0;
  setup.config.trv.stack = StackScheme::kRestartTrail;
  const std::uint64_t visit = kWideVisit + kDecode;
  EXPECT_EQ(alone(setup, walk), 4 * visit + kPop + visit) << "the root again";
  setup.config.trv.stack = StackScheme::kParent;
  EXPECT_EQ(alone(setup, walk), 4 * visit + kPop + 2 * (1 + visit)) << "nodes 1 and 0, each after its link";
  setup.parents_in_nodes = true;
  EXPECT_EQ(alone(setup, walk), 4 * visit + kPop + 2 * visit);
}

TEST(WideStack, AnEntryPerNodeServesAllItsChildren) {
  const Walk walk = joined({wide_visit(0, {5, 2, 7}), wide_visit(6, {}), wide_visit(3, {}), wide_visit(8, {})});
  TniHarness::Setup setup = wide_trv(8, 8);
  const auto stats_of = [&](StackPush push) {
    setup.config.trv.stack_push = push;
    TniHarness harness(setup);
    harness.add(walk).run();
    return trv(harness).stats();
  };
  EXPECT_EQ(stats_of(StackPush::kChild).pushes, 2U);
  const Trv::Stats stats = stats_of(StackPush::kNode);
  EXPECT_EQ(stats.pushes, 1U);
  EXPECT_EQ(stats.pops, 2U);
  EXPECT_EQ(stats.entry_updates, 1U);
}

TEST(WideStack, AnEntryPerNodeCannotCull) {
  const Walk walk = joined({wide_visit(0, {5, 2}), wide_visit(6, {})}, {traces::cull_step(1), end_step(false)});
  TniHarness::Setup setup = wide_trv(8, 8);
  const std::uint64_t visit = kWideVisit + kDecode;
  EXPECT_EQ(alone(setup, walk), 2 * visit + kPop);
  setup.config.trv.stack_push = StackPush::kNode;
  EXPECT_EQ(alone(setup, walk), 3 * visit + kPop) << "node 3 is visited";
  setup.wide_links[0].child[2] = traces::leaf_link(40, 2);
  TniHarness harness(setup);
  harness.add(walk).run();
  EXPECT_EQ(trv(harness).stats().extra_leaves, 1U);
  EXPECT_EQ(harness.tni().ist_of(0).stats().tests, 2U);
  EXPECT_EQ(harness.tni().ist_of(0).stats().edge_tests, 0U);
}

TEST(WidePrefetch, RequestsTheSecondHitChild) {
  const Walk walk = joined({wide_visit(0, {5, 2, 7}), wide_visit(6, {}), wide_visit(3, {}), wide_visit(8, {})});
  TniHarness::Setup setup = wide_trv(8, 8);
  setup.config.trv.prefetch = Prefetch::kSibling;
  TniHarness harness(setup);
  harness.add(walk).run();
  EXPECT_EQ(trv(harness).stats().prefetches, 1U);
  EXPECT_EQ(trv(harness).stats().l1_misses, 3U) << "nodes 0, 6 and 8; node 3 was prefetched";
}

TEST(Ists, ShareTheTraversalUnits) {
  const WideLoad load(3, 4);
  TniHarness::Setup setup;
  setup.config.trvs = 4;
  setup.config.ists = 3;
  setup.config.trv.stack = StackScheme::kFull;
  load.give(setup);
  TniHarness harness(setup);
  load.send(harness).run();
  ASSERT_EQ(harness.tni().ists().size(), 3U);
  std::uint64_t leaves = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    std::uint64_t sent = 0;
    for (std::size_t t = i; t < 4; t += 3) sent += harness.tni().trvs()[t]->stats().leaves;
    EXPECT_EQ(harness.tni().ists()[i]->stats().leaves_in, sent) << i;
    EXPECT_GT(sent, 0U);
    leaves += sent;
  }
  EXPECT_EQ(leaves, load.counts.leaves);
}

TEST(LeafRecords, AreReadOnceForAllTheirTriangles) {
  // A leaf of four triangles, whose tests all end with the distance, 8 cycles after the fetch of 2.
  const Walk walk = joined({wide_visit(0, {0})}, {leaf_step(0, 4), 0x1111, end_step(false)});
  TniHarness::Setup setup = wide_trv(8, 8);
  const auto cycles = [&](std::uint32_t bytes, std::vector<std::uint32_t> places, std::uint64_t lines) {
    setup.triangle_bytes = bytes;
    setup.triangle_places = std::move(places);
    TniHarness harness(setup);
    harness.add(walk).run();
    EXPECT_EQ(harness.tni().ist_of(0).stats().l1_hits, lines);
    EXPECT_EQ(harness.tni().ist_of(0).stats().tests, 4U);
    return alone(setup, walk);
  };
  const std::uint64_t four = cycles(64, {0, 4, 8, 12}, 4);
  EXPECT_EQ(cycles(64, {0, 0, 4, 4}, 2), four) << "two pairs: a test per cycle";
  EXPECT_EQ(cycles(128, {0, 0, 0, 0}, 2), four + 1) << "two lines come before the first test";
  EXPECT_EQ(cycles(128, {0, 0, 8, 8}, 4), four + 2);
  setup.decoded = true;
  setup.config.ist.decode_interval = 3;
  EXPECT_EQ(cycles(128, {0, 0, 0, 0}, 2), four + 1 + 3 * 2) << "three more triangles, each after two more cycles";
}

TEST(WideMachines, OracleAndAnyOrderOfUnitsGiveTheSameCounters) {
  for (std::uint64_t seed = 0; seed < 50; ++seed) {
    SCOPED_TRACE(seed);
    const std::uint32_t width = 2 + 2 * static_cast<std::uint32_t>(seed % 4);
    const WideLoad load(seed, width, 90, 100, seed % 3 == 0);
    TniHarness::Setup setup = test::random_wide_setup(seed);
    load.give(setup, 1 + static_cast<std::uint32_t>(seed / 4 % 4));
    TniHarness fast(setup), oracle(setup), shuffled(setup);
    load.send(fast).run();
    load.send(oracle).run<sim::Skip::kOff>();
    load.send(shuffled).run_shuffled(seed);
    EXPECT_EQ(counters_of(fast), counters_of(oracle));
    EXPECT_EQ(counters_of(fast), counters_of(shuffled));
    std::uint64_t visits = 0, leaves = 0, children = 0;
    for (const Trv* unit : fast.tni().trvs()) {
      const Trv::Stats s = unit->stats();
      visits += s.visits - s.restarted_visits - s.extra_visits;
      leaves += s.leaves - s.extra_leaves;
      children += s.children;
    }
    EXPECT_EQ(visits, load.counts.visits);
    EXPECT_EQ(leaves, load.counts.leaves);
    EXPECT_GE(children, load.counts.children);
  }
}

}  // namespace
}  // namespace hw
