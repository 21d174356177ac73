#include <algorithm>
#include <vector>

#include <gtest/gtest.h>

#include "tools/sampling/timed_tiles.h"

// Tests of plans that choose the tiles of a frame to simulate.

namespace tools {
namespace {

std::uint32_t measured(const TilePlan& plan) {
  std::uint32_t tiles = 0;
  for (std::size_t i = 1; i + 1 < plan.blocks.size(); ++i) tiles += plan.blocks[i].end - plan.blocks[i].measured;
  return tiles;
}

TEST(TilePlan, BlocksAreInOrderAndWarmWithTilesOfNoBlock) {
  const TilePlan plan = plan_tiles(std::vector<double>(5000, 1), 0.05, {}, 1);
  EXPECT_EQ(plan.blocks.front().first, 0U);
  EXPECT_EQ(plan.blocks.back().end, 5000U);
  for (std::size_t i = 1; i < plan.blocks.size(); ++i) {
    const tools::TimedBlock& block = plan.blocks[i];
    EXPECT_GE(block.first, plan.blocks[i - 1].end + block.warming);
    EXPECT_LT(block.first, block.measured);
    EXPECT_LT(block.measured, block.end);
  }
}

TEST(TilePlan, MeasuresTheRequestedShareOfTilesOfEqualCost) {
  for (const double share : {0.05, 0.1, 0.2}) {
    EXPECT_NEAR(measured(plan_tiles(std::vector<double>(20000, 7), share, {}, 1)) / 20000.0, share, share / 50);
  }
}

TEST(TilePlan, DearTilesAreTimedInProportionToTheirCost) {
  std::vector<double> costs(10000, 1);
  std::fill(costs.begin() + 5000, costs.end(), 3);
  const TilePlan plan = plan_tiles(costs, 0.1, {}, 1);
  double cheap = 0, dear = 0;
  for (std::size_t i = 1; i + 1 < plan.blocks.size(); ++i) (plan.blocks[i].first < 5000 ? cheap : dear) += 1;
  EXPECT_NEAR(dear / cheap, 3, 0.3);
}

TEST(TilePlan, TilesThatCostNothingAreNeverDrawn) {
  std::vector<double> costs(10000, 1);
  std::fill(costs.begin() + 1000, costs.begin() + 9000, 0);
  for (const tools::TimedBlock& block : plan_tiles(costs, 0.02, {}, 1).blocks) {
    EXPECT_TRUE(block.measured < 1000 || block.end > 9000) << block.first;
  }
}

TEST(TilePlan, AFrameOfFewTilesIsSimulatedWhole) {
  const TilePlan plan = plan_tiles(std::vector<double>(512, 1), 0.05, {}, 1);
  EXPECT_TRUE(plan.all);
  ASSERT_EQ(plan.blocks.size(), 1U);
  EXPECT_EQ(plan.blocks.front().end, 512U);
  EXPECT_FALSE(plan_tiles(std::vector<double>(2048, 1), 0.05, {}, 1).all);
  EXPECT_TRUE(plan_tiles(std::vector<double>(2048, 1), 1, {}, 1).all) << "all was asked for";
}

TEST(TilePlan, IsDrawnFromTheSeedAlone) {
  const std::vector<double> costs(5000, 1);
  const auto firsts = [&](std::uint64_t seed) {
    std::vector<std::uint32_t> out;
    for (const tools::TimedBlock& block : plan_tiles(costs, 0.05, {}, seed).blocks) out.push_back(block.first);
    return out;
  };
  EXPECT_EQ(firsts(1), firsts(1));
  EXPECT_NE(firsts(1), firsts(2));
}

}  // namespace
}  // namespace tools
