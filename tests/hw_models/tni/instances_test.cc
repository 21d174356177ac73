#include <gtest/gtest.h>

#include "tests/hw_models/tni/random_load.h"

// Tests of rays that enter and leave instances (bvh.instances: two_level).

namespace hw {
namespace {

using test::alone;
using test::kMiss, test::kPop, test::kVisit;
using test::kWires;
using test::RandomLoad;
using test::TniHarness;
using test::trv;
using test::Walk;
using traces::end_step;
using traces::instance_step;
using traces::visit_step;

constexpr std::uint64_t kTransform = 14;

/// A two-level tree. Nodes 0, 1, 2 are over two instances of a tree of nodes 3, 4, 5: instance 0 is below node 1,
/// instance 1 below node 2.
TniHarness::Setup two_instances() {
  TniHarness::Setup s = test::one_trv();
  s.placed.resize(2);
  s.placed[0].root = s.placed[1].root = 3;
  s.links.resize(6);
  s.parents = {0, 0, 0, 3, 3, 4, 1, 2};
  return s;
}

const Walk kIn = {visit_step(0, 1, 0), instance_step(0), visit_step(3, 0, 0), end_step(false)};
/// Returns a traversal that enters instance 0, pops the stack entry of node 0, and enters instance 1.
const Walk kBoth = {visit_step(0, 3, 0), visit_step(1, 1, 0), instance_step(0),    visit_step(3, 0, 0),
                    visit_step(2, 1, 0), instance_step(1),    visit_step(3, 0, 0), end_step(false)};

TEST(Instances, EnteringReadsTheRecordAndTakesTheTransformsLatencyInsteadOfAVisits) {
  EXPECT_EQ(alone(two_instances(), kIn), 2 * kVisit + kTransform);
  TniHarness::Setup slow = two_instances();
  slow.config.trv.transform_latency = 20;
  EXPECT_EQ(alone(slow, kIn), 2 * kVisit + kTransform + 8);
  TniHarness harness(two_instances());
  harness.add(kIn).run();
  EXPECT_EQ(harness.latency(0), kWires + 2 * (kMiss + kVisit) + kMiss + kTransform);
  EXPECT_EQ(harness.lines_requested(), 3U);
  EXPECT_EQ(trv(harness).stats().transforms, 1U);
  EXPECT_EQ(trv(harness).stats().visits, 2U);
  EXPECT_EQ(trv(harness).stats().leaves, 0U);
}

TEST(Instances, LeavingCostsThePopAlone) {
  EXPECT_EQ(alone(two_instances(), kBoth), 5 * kVisit + 2 * kTransform + kPop);
}

TEST(Instances, OneOperationPerCycleEntersTheBoxPipe) {
  TniHarness::Setup setup = two_instances();
  setup.config.trv.rays = 64;
  setup.ideal.l1 = true;
  TniHarness harness(setup);
  harness.add(kIn, 1000).run();
  EXPECT_NEAR(static_cast<double>(harness.span()), 3000, 100);
  EXPECT_EQ(trv(harness).activity().spent(Trv::CycleReason::kVisiting), std::uint64_t{3000} * 2'000'000);
}

/// Returns a traversal that pushes at nodes 0 and 1 (over instances) and at 3 and 4 (in instance 0). All entries are
/// popped again.
const Walk kDeep = {visit_step(0, 3, 0), visit_step(1, 3, 0), instance_step(0),    visit_step(3, 3, 0),
                    visit_step(4, 3, 0), visit_step(5, 0, 0), visit_step(5, 0, 0), visit_step(5, 0, 0),
                    visit_step(2, 0, 0), visit_step(2, 0, 0), end_step(false)};

TEST(Instances, ARestartFromALinkOutsideEntersTheInstanceAgain) {
  TniHarness::Setup setup = two_instances();
  setup.config.trv.stack_entries = 1;
  TniHarness harness(setup);
  harness.add(kDeep).run();
  const Trv::Stats& s = trv(harness).stats();
  // Node 4's entry is in the short stack. Node 3's was dropped: its restart begins at the link, node 0, and visits 0,
  // 1, the instance and 3. Restarts for the entries of 1 and 0 visit 0 and 1, and 0; neither enters the instance.
  EXPECT_EQ(s.restarts, 3U);
  EXPECT_EQ(s.restarted_visits, 3U + 2U + 1U);
  EXPECT_EQ(s.transforms, 1U + 1U);
  EXPECT_EQ(s.visits, 9U + 6U);
  EXPECT_EQ(alone(setup, kDeep), (9 + 6) * kVisit + 2 * kTransform + (4 + 3) * kPop);
}

TEST(Instances, ARestartFromALinkWithinTheInstanceStaysThere) {
  const Walk inside = {visit_step(0, 1, 0), visit_step(1, 1, 0), instance_step(0),
                       visit_step(3, 3, 0), visit_step(4, 3, 0), visit_step(5, 0, 0),
                       visit_step(5, 0, 0), visit_step(5, 0, 0), end_step(false)};
  TniHarness::Setup setup = two_instances();
  setup.config.trv.stack_entries = 1;
  TniHarness harness(setup);
  harness.add(inside).run();
  EXPECT_EQ(trv(harness).stats().restarts, 1U);
  EXPECT_EQ(trv(harness).stats().restarted_visits, 1U);
  EXPECT_EQ(trv(harness).stats().transforms, 1U);
}

TEST(Instances, ARestartTrailGoesDownFromTheRootOfAllThroughTheInstance) {
  TniHarness::Setup setup = two_instances();
  setup.config.trv.stack = StackScheme::kRestartTrail;
  setup.config.trv.stack_entries = 0;
  TniHarness harness(setup);
  harness.add(kDeep).run();
  const Trv::Stats& s = trv(harness).stats();
  // Restarts for the stack entries of nodes 4 and 3 enter the instance; those for nodes 1 and 0 do not.
  EXPECT_EQ(s.restarts, 4U);
  EXPECT_EQ(s.restarted_visits, (2U + 2U) + (2U + 1U) + 2U + 1U);
  EXPECT_EQ(s.transforms, 1U + 2U);
}

TEST(Instances, EveryStackDoesTheSameWork) {
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    const RandomLoad load(seed, 400, 300, true);
    std::vector<std::uint64_t> entered;
    for (const StackScheme stack : {StackScheme::kFull, StackScheme::kRestartLink, StackScheme::kRestartTrail}) {
      for (const std::uint32_t entries : {1U, 3U}) {
        TniHarness::Setup setup;
        setup.config.trvs = 1;
        setup.config.trv.stack = stack;
        setup.config.trv.stack_entries = entries;
        load.give(setup);
        TniHarness harness(setup);
        load.send(harness).run();
        const Trv::Stats& s = trv(harness).stats();
        EXPECT_EQ(s.rays_out, load.walks.size());
        entered.push_back(s.visits - s.restarted_visits);
      }
    }
    EXPECT_EQ(std::ranges::count(entered, entered.front()), 6) << seed;
  }
}

}  // namespace
}  // namespace hw
