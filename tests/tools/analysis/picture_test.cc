#include "tools/analysis/picture.h"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

namespace test {
namespace {

using tools::mean_squared_error;
using tools::psnr_db;
using Picture = std::vector<float>;

TEST(Srgb, HasTheStandardsEndsKneeAndMiddle) {
  EXPECT_EQ(tools::srgb_encoded(0), 0);
  EXPECT_FLOAT_EQ(tools::srgb_encoded(1), 1);
  EXPECT_FLOAT_EQ(tools::srgb_encoded(0.001F), 0.01292F) << "straight below the knee";
  EXPECT_NEAR(tools::srgb_encoded(0.0031308F), tools::srgb_encoded(0.0031309F), 1e-5) << "without a step";
  EXPECT_NEAR(tools::srgb_encoded(0.5F), 0.735357F, 1e-6F);
}

TEST(Srgb, EightBitsAreRoundedAndClamped) {
  EXPECT_EQ(tools::to_rgb8(Picture{-1, 0, 0.5F, 1, 7}), (std::vector<std::uint8_t>{0, 0, 188, 255, 255}));
}

TEST(Difference, IsEightTimesTheDistanceOfEncodedValues) {
  const std::vector<float> a = {0, 1, 1, 0.5F}, b = {0, 0, 0.995F, 0.5F};
  const std::vector<std::uint8_t> shown = tools::difference_rgb8(a, b);
  EXPECT_EQ(shown[0], 0);
  EXPECT_EQ(shown[1], 255) << "clamped";
  EXPECT_EQ(shown[2], std::lround(255 * 8 * (1 - tools::srgb_encoded(0.995F))));
  EXPECT_EQ(shown[3], 0);
}

TEST(Psnr, OfIdenticalPicturesIsNothing) {
  EXPECT_FALSE(psnr_db(mean_squared_error(Picture{0, 0.25F, 1}, Picture{0, 0.25F, 1})).has_value());
  EXPECT_FALSE(psnr_db(mean_squared_error(Picture{1, 2, 3}, Picture{1, 9, 1.5F})).has_value())
      << "brighter than white is white";
}

TEST(Psnr, OfBlackAndWhiteIsZero) {
  EXPECT_NEAR(psnr_db(mean_squared_error(Picture{0, 0, 0}, Picture{1, 1, 1})).value(), 0, 1e-5);
}

TEST(Psnr, OfOneWrongValueInAHundredIsTwentyDecibels) {
  Picture black(100, 0.0F), one_white = black;
  one_white[37] = 1;
  EXPECT_NEAR(psnr_db(mean_squared_error(black, one_white)).value(), 20, 1e-5);
  EXPECT_EQ(psnr_db(mean_squared_error(one_white, black)), psnr_db(mean_squared_error(black, one_white)));
}

TEST(Psnr, SeesEncodedNotLinearValues) {
  const Picture black(3, 0.0F), grey(3, 0.5F);
  EXPECT_NEAR(psnr_db(mean_squared_error(black, grey)).value(), -20 * std::log10(0.735357), 1e-4);
}

}  // namespace
}  // namespace test
