#include "tools/analysis/picture.h"

#include <cmath>
#include <optional>
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

/// Returns the error of the change to the second of two frames; no value if all changes are right.
std::optional<double> change_psnr(const std::vector<Picture>& frames, const std::vector<Picture>& references) {
  tools::PictureComparison comparison;
  EXPECT_FALSE(comparison.compare_frame(frames[0], references[0]).change.has_value()) << "nothing came before";
  const tools::PictureError second = comparison.compare_frame(frames[1], references[1]);
  EXPECT_EQ(second.squared, mean_squared_error(frames[1], references[1]));
  return psnr_db(second.change.value());
}

TEST(TemporalPsnr, OfAnErrorThatStaysIsNothing) {
  EXPECT_FALSE(change_psnr({{1, 0.5F}, {1, 0.5F}}, {{0, 0.5F}, {0, 0.5F}}).has_value()) << "a constant picture";
  EXPECT_FALSE(change_psnr({{1, 0, 0}, {0, 1, 0}}, {{1, 0, 0}, {0, 1, 0}}).has_value()) << "it moves as the reference";
}

TEST(TemporalPsnr, OfADotThatMovesFalselyCountsTwoPixels) {
  Picture black(100, 0.0F), first = black, second = black;
  first[37] = 1;
  second[38] = 1;
  EXPECT_NEAR(change_psnr({first, second}, {black, black}).value(), 10 * std::log10(100 / 2.0), 1e-5);
  EXPECT_NEAR(change_psnr({black, black}, {first, second}).value(), 10 * std::log10(100 / 2.0), 1e-5)
      << "a change that is missing is as false";
  EXPECT_NEAR(change_psnr({first, black}, {black, black}).value(), 20, 1e-5);
}

TEST(TemporalPsnr, OfAFlashInTheOppositeDirectionIsBelowZero) {
  const Picture black(12, 0.0F), white(12, 1.0F);
  EXPECT_NEAR(change_psnr({black, white}, {white, black}).value(), -10 * std::log10(4.0), 1e-5);
}

TEST(TemporalPsnr, ComparesWithTheFrameBeforeOnly) {
  const Picture black(4, 0.0F), white(4, 1.0F);
  tools::PictureComparison comparison;
  comparison.compare_frame(white, black);
  EXPECT_NEAR(comparison.compare_frame(black, black).change.value(), 1, 1e-6);
  EXPECT_EQ(comparison.compare_frame(black, black).change, 0.0);
}

}  // namespace
}  // namespace test
