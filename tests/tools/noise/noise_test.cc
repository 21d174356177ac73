#include "tools/noise/noise.h"

#include <gtest/gtest.h>

// Noise that is assumed where none was measured.

namespace tools {
namespace {

TEST(DefaultNoise, IsThatOfThePage) {
  EXPECT_EQ(default_noise(2048.0 * 1024), 0.02);
  EXPECT_EQ(default_noise(1024.0 * 512), 0.02);
  EXPECT_EQ(default_noise(1024.0 * 512 - 1), 0.05);
  EXPECT_EQ(default_noise(512.0 * 256), 0.05);
  EXPECT_EQ(default_noise(256.0 * 128), 0.10);
}

TEST(AssumedDraw, TwoRunsOfOneDesignDifferByItsNoise) {
  const MeanDifference d = difference_of(AssumedDraw{100, 0.02}, AssumedDraw{100, 0.02});
  EXPECT_EQ(d.value, 0);
  EXPECT_NEAR(d.half_width(), 2, 1e-9);
}

TEST(NoisyFigures, AreThoseThatRacesMove) {
  EXPECT_TRUE(is_noisy("cycles"));
  EXPECT_TRUE(is_noisy("energy_mj.nominal"));
  EXPECT_FALSE(is_noisy("area_mm2"));
  EXPECT_FALSE(is_noisy("rays.total"));
}

}  // namespace
}  // namespace tools
