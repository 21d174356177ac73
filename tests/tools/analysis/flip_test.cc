#include "tools/analysis/flip.h"

#include <cstddef>
#include <vector>

#include <gtest/gtest.h>

namespace tools {
namespace {

constexpr std::uint32_t kSide = 48;

std::vector<float> plain(float r, float g, float b) {
  std::vector<float> rgb;
  for (std::size_t i = 0; i < std::size_t{kSide} * kSide; ++i) rgb.insert(rgb.end(), {r, g, b});
  return rgb;
}

TEST(Flip, EqualPicturesHaveNoError) {
  const std::vector<float> grey = plain(0.2F, 0.4F, 0.6F);
  EXPECT_EQ(mean_flip(grey, grey, kSide), 0);
}

TEST(Flip, BlackAndWhiteDifferMost) {
  // HyAB 100, to the power 0.7 is 25.12. Green and blue, which differ most after the Hunt effect, have 41.27.
  // 0.95 + (25.12 - 0.4 x 41.27) / (0.6 x 41.27) x 0.05
  const double error = mean_flip(plain(0, 0, 0), plain(1, 1, 1), kSide);
  EXPECT_NEAR(error, 0.9674, 2e-3);
}

TEST(Flip, GreenAndBlueAreAtTheLimit) { EXPECT_NEAR(mean_flip(plain(0, 1, 0), plain(0, 0, 1), kSide), 1, 1e-3); }

TEST(Flip, ErrorGrowsWithTheDifferenceAndIsSymmetric) {
  const std::vector<float> grey = plain(0.2F, 0.2F, 0.2F), near = plain(0.21F, 0.2F, 0.2F),
                           far = plain(0.3F, 0.2F, 0.2F);
  EXPECT_GT(mean_flip(grey, near, kSide), 0);
  EXPECT_LT(mean_flip(grey, near, kSide), mean_flip(grey, far, kSide));
  EXPECT_DOUBLE_EQ(mean_flip(grey, far, kSide), mean_flip(far, grey, kSide));
}

TEST(Flip, AnEdgeCountsMoreThanAPlainDifference) {
  std::vector<float> with_edge = plain(0.2F, 0.2F, 0.2F);
  const std::vector<float> flat = with_edge;
  for (std::size_t i = 0; i < with_edge.size(); ++i) {
    if (i / 3 % kSide >= kSide / 2) with_edge[i] = 0.25F;
  }
  const double with_feature = mean_flip(flat, with_edge, kSide);
  const double half_plain = mean_flip(flat, plain(0.25F, 0.25F, 0.25F), kSide) / 2;
  EXPECT_GT(with_feature, half_plain);
}

}  // namespace
}  // namespace tools
