#include <numeric>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "hw_models/tni/predictor_stage.h"
#include "hw_models/tni/traversal_slot.h"
#include "tests/hw_models/tni/random_load.h"
#include "tests/hw_models/tni/wide_load.h"

// Tests of rays that begin at a predicted node: look-ups, stacks and restarts.

namespace hw {
namespace {

using test::alone;
using test::kPop, test::kVisit;
using test::one_trv;
using test::RandomLoad;
using test::TniHarness;
using test::trv;
using test::Walk;
using traces::end_step;
using traces::kNoPrediction;
using traces::look_up_step;
using traces::visit_step;

const Walk kPlain = {visit_step(0, 3, 0), visit_step(1, 0, 0), visit_step(2, 0, 0), end_step(false)};
const Walk kUnpredicted = {look_up_step(kNoPrediction, false, true), visit_step(0, 3, 0), visit_step(1, 0, 0),
                           visit_step(2, 0, 0), end_step(true)};
// Node 5, of two children that are hit. The second one's visit ends the walk.
const Walk kCorrect = {look_up_step(5, true, true), visit_step(5, 3, 0), visit_step(11, 0, 0), visit_step(12, 0, 0),
                       end_step(true)};
const Walk kWrong = {look_up_step(5, false, false), visit_step(5, 0, 0), visit_step(0, 3, 0),
                     visit_step(1, 0, 0),           visit_step(2, 0, 0), end_step(false)};

TniHarness::Setup with_predictor(std::uint32_t latency = 2) {
  TniHarness::Setup setup = one_trv();
  setup.config.predictor = {.enabled = true, .latency = latency};
  return setup;
}

TEST(PredictorStage, AddsItsLatencyToEveryRay) {
  TniHarness without(one_trv());
  without.add(kPlain).run();
  for (const std::uint32_t latency : {1U, 2U, 7U}) {
    for (const Walk& walk : {kPlain, kUnpredicted}) {
      TniHarness harness(with_predictor(latency));
      harness.add(walk).run();
      EXPECT_EQ(harness.latency(0), without.latency(0) + latency);
    }
  }
}

TEST(PredictorStage, PassesOneRayPerCycle) {
  TniHarness::Setup setup = with_predictor();
  setup.config.trvs = 4;
  setup.config.trv.rays = 64;
  setup.ideal.l1 = true;
  TniHarness harness(setup);
  const Walk shortest = {look_up_step(kNoPrediction, false, false), visit_step(0, 0, 0), end_step(false)};
  harness.add(shortest, 1000).run();
  EXPECT_NEAR(static_cast<double>(harness.span()), 1000, 40);
}

TEST(PredictorStage, CountsTheOutcomesOfLookUps) {
  TniHarness harness(with_predictor());
  harness.add(kPlain, 2).add(kUnpredicted, 3).add(kCorrect, 5).add(kWrong, 7).run();
  const PredictorStage::Stats& s = harness.tni().predictor()->stats();
  EXPECT_EQ(s.rays, 17U);
  EXPECT_EQ(s.look_ups, 15U);
  EXPECT_EQ(s.predicted, 12U);
  EXPECT_EQ(s.correct, 5U);
  EXPECT_EQ(s.wrong, 7U);
  EXPECT_EQ(s.updates, 8U);
  EXPECT_EQ(trv(harness).stats().visits, (2 + 3) * 3U + 5 * 3U + 7 * 4U);
  EXPECT_EQ(trv(harness).stats().pops, 2U + 3 + 5 + 7) << "the pop that continues at the root reads no entry";
  EXPECT_EQ(harness.arrived().size(), 17U);
}

TEST(PredictedWalk, TakesTheCyclesOfItsVisitsAndPops) {
  const std::uint64_t plain = 3 * kVisit + kPop;
  // The look-up happens while the previous ray is traversed.
  EXPECT_EQ(alone(with_predictor(), kUnpredicted), plain);
  EXPECT_EQ(alone(with_predictor(), kCorrect), plain);
  EXPECT_EQ(alone(with_predictor(), kWrong), kVisit + kPop + plain) << "the subtree and the return to the root";
}

TEST(PredictedWalk, RestartsAtThePredictedNodeUntilItsSubtreeIsFinished) {
  // A complete binary tree of fifteen nodes: the children of node n are 2n + 1 and 2n + 2.
  std::vector<std::uint32_t> parents{0};
  for (std::uint32_t node = 1; node < 15; ++node) parents.push_back((node - 1) / 2);
  TreeInMemory tree;
  tree.parents = parents;
  // Below node 1, entries of nodes 1 and 3; from the root, an entry of the root.
  Walk walk = {visit_step(1, 3, 0), visit_step(3, 3, 0), visit_step(7, 0, 0), visit_step(8, 0, 0), visit_step(4, 0, 0),
               visit_step(0, 3, 0), visit_step(1, 0, 0), visit_step(2, 0, 0), end_step(false)};
  walk.resize(walk.size() + 16, end_step(false));
  const StackRules rules{StackScheme::kRestartTrail, 0};
  TraversalSlot slot(walk.data(), 0);
  StackStats stats;
  const auto restarted = [&] {
    std::vector<StackEntryOrigin> scratch;
    RestartPath path;
    EXPECT_FALSE(slot.pop_stack_entry(stats));
    slot.restart_walk(walk.data(), tree, rules, scratch, path, stats);
    std::vector<std::uint32_t> nodes;
    while (slot.is_restarting()) {
      nodes.push_back(path.next_node());
      slot.complete_replayed_visit(path);
    }
    EXPECT_TRUE(slot.consume_entry());
    return nodes;
  };
  const auto visit = [&](std::uint32_t node) {
    EXPECT_EQ(slot.next_pipe(), TraversalSlot::kToInner);
    EXPECT_EQ(traces::node_of(slot.next_step()), node);
    slot.advance_to_next_step(0, false, stats);
  };
  for (const std::uint32_t node : {1U, 3U, 7U}) visit(node);
  EXPECT_EQ(restarted(), (std::vector<std::uint32_t>{1, 3}));
  visit(8);
  EXPECT_EQ(restarted(), (std::vector<std::uint32_t>{1}));
  visit(4);
  EXPECT_EQ(slot.next_pipe(), TraversalSlot::kToStack);
  EXPECT_TRUE(slot.pop_stack_entry(stats)) << "continues at the root";
  for (const std::uint32_t node : {0U, 1U}) visit(node);
  EXPECT_EQ(restarted(), (std::vector<std::uint32_t>{0}));
  visit(2);
  EXPECT_EQ(slot.next_pipe(), TraversalSlot::kToRetire);
}

/// Returns the words of a random walk below node `top` of a RandomLoad's tree, without culls. `correct`: the walk ends
/// at its first leaf; returns no words if it visits none.
Walk subtree_walk(std::uint64_t seed, std::uint32_t top, std::uint32_t nodes, bool correct) {
  Walk out;
  std::vector<std::uint32_t> stack{top};
  for (std::uint32_t step = 0; !stack.empty(); ++step) {
    const std::uint32_t node = stack.back();
    stack.pop_back();
    if (RandomLoad::is_leaf(node, nodes)) {
      out.insert(out.end(), {traces::leaf_step(node * 4, 1), correct ? 3U : 1U});
      if (correct) return out;
      continue;
    }
    const auto hits = static_cast<std::uint32_t>(sim::hash(seed, step) % 4);
    out.push_back(visit_step(node, hits, 0));
    if ((hits & 2) != 0) stack.push_back(2 * node + 2);
    if ((hits & 1) != 0) stack.push_back(2 * node + 1);
  }
  return correct ? Walk{} : out;
}

std::string report_of(TniHarness& harness) {
  std::string all;
  for (const sim::UnitReport& unit : harness.machine().report()) {
    all += unit.path;
    for (const auto& [reason, cycles] : unit.cycles_by_reason) all += fmt::format(" {}={}", reason, cycles);
    for (const sim::CounterReport& c : unit.counters) all += fmt::format(" {}={}", c.name, c.value);
    all += "\n";
  }
  return all;
}

TEST(PredictedWalk, GivesTheOraclesCountersOnEveryMachine) {
  constexpr std::uint32_t kNodes = 400;
  std::uint64_t restarts = 0, wrongs = 0;
  for (std::uint64_t seed = 0; seed < 60; ++seed) {
    SCOPED_TRACE(seed);
    RandomLoad load(seed, kNodes, 150);
    std::uint64_t visits = 0;
    for (std::size_t i = 0; i < load.walks.size(); ++i) {
      Walk& walk = load.walks[i];
      const std::uint64_t h = sim::hash(seed, i, 77);
      const auto top = static_cast<std::uint32_t>(1 + h % 150);
      const bool correct = h / 1000 % 3 == 0;
      const Walk below = h / 10000 % 4 == 0 ? Walk{} : subtree_walk(h, top, kNodes, correct);
      if (below.empty()) {
        walk.insert(walk.begin(), look_up_step(kNoPrediction, false, h % 2 == 0));
      } else if (correct) {
        walk = below;
        walk.insert(walk.begin(), look_up_step(top, true, true));
        walk.push_back(end_step(true));
      } else {
        walk.insert(walk.begin(), below.begin(), below.end());
        walk.insert(walk.begin(), look_up_step(top, false, false));
        wrongs += 1;
      }
      visits += traces::count_steps(walk).visits;
      walk.resize(walk.size() + 16, end_step(false));
    }
    TniHarness::Setup setup = test::random_setup(seed);
    if (seed % 4 == 3 && setup.config.trv.gather == Gather::kOff) setup.config.trv.stack = StackScheme::kParent;
    setup.config.predictor = {.enabled = true, .latency = 1 + static_cast<std::uint32_t>(seed % 4)};
    load.give(setup);
    TniHarness fast(setup), oracle(setup), shuffled(setup);
    load.send(fast).run();
    load.send(oracle).run<sim::Skip::kOff>();
    load.send(shuffled).run_shuffled(seed);
    EXPECT_EQ(report_of(fast), report_of(oracle));
    EXPECT_EQ(report_of(fast), report_of(shuffled));
    std::uint64_t first_visits = 0;
    for (const Trv* unit : fast.tni().trvs()) {
      first_visits += unit->stats().visits - unit->stats().restarted_visits;
      restarts += unit->stats().restarts;
    }
    EXPECT_EQ(first_visits, visits);
  }
  EXPECT_GT(restarts, 1000U);
  EXPECT_GT(wrongs, 1000U);
}

/// Returns the words of a random walk below node `top` of a tree of wide nodes, without culls.
Walk wide_subtree_walk(const test::WideLoad& load, std::uint64_t seed, std::uint32_t top) {
  Walk out;
  std::vector<std::uint32_t> stack{top};
  for (std::uint32_t step = 0; !stack.empty(); ++step) {
    const std::uint32_t link = stack.back();
    stack.pop_back();
    if (traces::is_leaf(link)) {
      out.insert(out.end(), {traces::leaf_step(traces::leaf_first(link), 1), 1U});
      continue;
    }
    std::vector<std::uint32_t> order(sim::hash(seed, step) % (load.children_of(link) + 1));
    std::iota(order.begin(), order.end(), 0U);
    const auto words = test::wide_visit(link, order);
    out.insert(out.end(), words.begin(), words.end());
    for (std::size_t i = order.size(); i-- > 0;) stack.push_back(load.nodes[link].child[order[i]]);
  }
  return out;
}

TEST(PredictedWalk, MayKeepStackEntriesThatAreNodes) {
  std::uint64_t restarts = 0, extras = 0;
  for (std::uint64_t seed = 0; seed < 40; ++seed) {
    SCOPED_TRACE(seed);
    test::WideLoad load(seed, 2 + static_cast<std::uint32_t>(seed % 7));
    std::uint64_t visits = 0;
    for (std::size_t i = 0; i < load.walks.size(); ++i) {
      Walk& walk = load.walks[i];
      const std::uint64_t h = sim::hash(seed, i, 78);
      const auto top = static_cast<std::uint32_t>(1 + h % (load.nodes.size() - 1));
      const Walk below = h / 1000 % 3 == 0 ? Walk{} : wide_subtree_walk(load, h, top);
      walk.insert(walk.begin(), below.begin(), below.end());
      walk.insert(walk.begin(), look_up_step(below.empty() ? kNoPrediction : top, false, false));
      visits += traces::count_steps(walk).visits;
    }
    TniHarness::Setup setup = test::random_wide_setup(seed);
    setup.config.trv.stack_push = StackPush::kNode;
    setup.config.predictor.enabled = true;
    load.give(setup);
    TniHarness fast(setup), oracle(setup);
    load.send(fast).run();
    load.send(oracle).run<sim::Skip::kOff>();
    EXPECT_EQ(report_of(fast), report_of(oracle));
    std::uint64_t first_visits = 0;
    for (const Trv* unit : fast.tni().trvs()) {
      first_visits += unit->stats().visits - unit->stats().restarted_visits - unit->stats().extra_visits;
      restarts += unit->stats().restarts;
      extras += unit->stats().extra_visits;
    }
    EXPECT_EQ(first_visits, visits);
  }
  EXPECT_GT(restarts, 100U);
  EXPECT_GT(extras, 100U);
}

}  // namespace
}  // namespace hw
