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

}  // namespace
}  // namespace traces::test
