#include <vector>

#include <gtest/gtest.h>

#include "traces/walk.h"

namespace traces::test {
namespace {

TEST(CountSteps, CountsNodesAndTrianglesOfWalksBackToBack) {
  // The word of exit phases after a leaf may have any value. An enter step has no second word.
  const std::vector<std::uint32_t> words = {
      visit_step(0, 1, 0), instance_step(0),    visit_step(3, 3, 0), leaf_step(7, 2), 0x33, cull_step(1),
      end_step(true),      visit_step(0, 0, 0), end_step(false),     leaf_step(0, 1), 0x1,  end_step(false)};
  EXPECT_EQ(count_steps(words).visits, 3U);
  EXPECT_EQ(count_steps(words).tests, 2U + 1U);
  EXPECT_EQ(count_steps(words).total_steps(), 3U + 2U + 1U);
}

TEST(CountSteps, CountsAWideVisitOfTwoWordsOnce) {
  // The second word may look like any step.
  const std::vector<std::uint32_t> words = {
      wide_step(0),   wide_hits(0xff, 076543210), wide_step(kMaxNodes - 1), wide_hits(0x40, 6), leaf_step(7, 2), 0x33,
      end_step(false)};
  EXPECT_EQ(count_steps(words).visits, 2U);
  EXPECT_EQ(count_steps(words).tests, 2U);
}

TEST(WideStep, KeepsTheOrderOfHitChildrenAndDiffersFromEveryBinaryVisit) {
  const std::uint32_t hits = wide_hits(0b10010100, 7U << 6 | 2U << 3 | 4U);
  EXPECT_EQ(hit_count_of(hits), 3U);
  EXPECT_EQ(hit_slot_of(hits, 0), 4U);
  EXPECT_EQ(hit_slot_of(hits, 1), 2U);
  EXPECT_EQ(hit_slot_of(hits, 2), 7U);
  EXPECT_TRUE(is_wide(wide_step(5)));
  EXPECT_EQ(node_of(wide_step(5)), 5U);
  EXPECT_EQ(kind_of(wide_step(5)), StepKind::kVisit);
  for (std::uint32_t mask = 0; mask < 4; ++mask) EXPECT_FALSE(is_wide(visit_step(5, mask, mask == 3 ? 1 : 0)));
}

}  // namespace
}  // namespace traces::test
