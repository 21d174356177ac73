#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <gtest/gtest.h>

#include "tools/sampling/timed_tiles.h"

// Tests of plans that split a frame's tiles into slices.

namespace tools {
namespace {

constexpr SliceShape kShape{.lead = 12, .probe = 6, .warming = 16};

TEST(SlicePlan, SlicesFollowEachOtherAndHaveALeadAndWhatWarmsBeforeIt) {
  const std::vector<Slice> plan = plan_slices(std::vector<double>(800, 1), 4, kShape);
  ASSERT_EQ(plan.size(), 4U);
  EXPECT_EQ(plan.front().begin(), 0U);
  EXPECT_EQ(plan.back().end, 800U);
  for (std::size_t i = 1; i < plan.size(); ++i) {
    EXPECT_EQ(plan[i].first, plan[i - 1].end);
    EXPECT_EQ(plan[i].first, 200 * i);
    EXPECT_EQ(plan[i].lead, 12U);
    EXPECT_EQ(plan[i].begin(), plan[i].first - 16);
  }
}

TEST(SlicePlan, ShortSlicesAndThoseOfSmallFramesHaveLeadsTwiceAsLongWhichDoTheWarming) {
  const std::vector<Slice> are_short = plan_slices(std::vector<double>(800, 1), 20, kShape);
  EXPECT_EQ(are_short[1].lead, 24U);
  EXPECT_EQ(are_short[1].begin(), 16U);
  const std::vector<Slice> of_a_small_frame = plan_slices(std::vector<double>(400, 1), 2, kShape);
  EXPECT_EQ(of_a_small_frame[1].begin(), 200U - 24);
  const std::vector<Slice> as_short_as_leads = plan_slices(std::vector<double>(120, 1), 10, kShape);
  EXPECT_EQ(as_short_as_leads[1].begin(), 0U) << "there are no more tiles before it";
  EXPECT_EQ(as_short_as_leads[9].begin(), 108U - 24);
  // A frame of fewer tiles than fifty leads is small, a slice of fewer than five leads is short.
  EXPECT_EQ(plan_slices(std::vector<double>(599, 1), 2, kShape)[1].lead, 24U);
  EXPECT_EQ(plan_slices(std::vector<double>(600, 1), 2, kShape)[1].lead, 12U);
  EXPECT_EQ(plan_slices(std::vector<double>(1200, 1), 20, kShape)[1].lead, 12U);
  EXPECT_EQ(plan_slices(std::vector<double>(1199, 1), 20, kShape)[1].lead, 24U);
}

TEST(SlicePlan, SlicesCostTheSameAsFarAsEachHasTilesEnough) {
  std::vector<double> costs(300, 1);
  std::fill(costs.begin() + 200, costs.end(), 3);
  EXPECT_EQ(plan_slices(costs, 2, kShape).front().end, 217U) << "250 of 500";
  std::fill(costs.begin(), costs.end(), 0);
  costs.front() = 1;
  const std::vector<Slice> front_heavy = plan_slices(costs, 25, kShape);
  for (const Slice& slice : front_heavy) EXPECT_GE(slice.end - slice.first, 12U);
  EXPECT_EQ(front_heavy.back().end, 300U);
}

}  // namespace
}  // namespace tools
