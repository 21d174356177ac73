#include "tools/analysis/picture.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <optional>
#include <string_view>
#include <vector>

#include <gtest/gtest.h>

#include "shader_kernels/programs/program_spec.h"
#include "traces/accel/build.h"
#include "traces/scenes/library.h"

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

using Colour = std::array<std::uint8_t, 3>;

/// Returns a picture of one row of grey pixels with these sample marks.
RenderResult row_of(std::vector<kernels::SampleMark> marks) {
  RenderResult frame;
  frame.rgb.assign(3 * marks.size(), 0.5F);
  frame.marks = std::move(marks);
  return frame;
}

std::vector<Colour> picture_of(const std::vector<DebugPicture>& pictures, std::string_view name) {
  const auto at = std::ranges::find(pictures, name, &DebugPicture::name);
  if (at == pictures.end()) return {};
  std::vector<Colour> out;
  for (std::size_t i = 0; i < at->rgb.size(); i += 3) out.push_back({at->rgb[i], at->rgb[i + 1], at->rgb[i + 2]});
  return out;
}

TEST(DebugPictures, ReferencesAreApartFromWhatIsInterpolatedAndWhatIsTraced) {
  using kernels::kCorrectedMark, kernels::kReferenceMark, kernels::kTracedMark;
  const RenderResult frame = row_of({kTracedMark | kReferenceMark, 0, kTracedMark | 1, kTracedMark | kCorrectedMark});
  const std::vector<DebugPicture> pictures = debug_pictures(kernels::parse_program("multirate:under"), frame, 4, 1);
  const std::vector<Colour> similar = picture_of(pictures, "similar");
  ASSERT_EQ(similar.size(), 4U);
  for (std::size_t i = 0; i < 4; ++i) {
    for (std::size_t k = 0; k < i; ++k) EXPECT_NE(similar[i], similar[k]) << i << ' ' << k;
  }
  const std::uint8_t grey = to_rgb8(frame.rgb)[0];
  const Colour black{0, 0, 0}, shown{grey, grey, grey};
  EXPECT_EQ(picture_of(pictures, "interpolated"), (std::vector<Colour>{black, shown, black, black}));
}

TEST(DebugPictures, RoundsOfPropagationAreShownWhereThereWereAny) {
  RenderResult frame = row_of({0, kernels::kCorrectedMark | 1U << kernels::kActiveCountShift});
  const kernels::ProgramSpec program = kernels::parse_program("supersample");
  EXPECT_TRUE(picture_of(debug_pictures(program, frame, 2, 1), "propagated").empty());
  frame.sampling.propagated = 1;
  const std::vector<Colour> shown = picture_of(debug_pictures(program, frame, 2, 1), "propagated");
  ASSERT_EQ(shown.size(), 2U);
  EXPECT_EQ(shown[1], (Colour{255, 255, 255}));
  EXPECT_LT(shown[0][0], 128);
}

TEST(DebugPictures, WeightsAndEdgesOfReconstructAreShownWhereThereAreAny) {
  const auto edge_bit = [](kernels::FilterEdge edge) { return 1U << static_cast<std::uint32_t>(edge); };
  const std::uint32_t all = 255U << kernels::kWeightShift;
  const RenderResult frame = row_of(
      {static_cast<kernels::SampleMark>(all), static_cast<kernels::SampleMark>(edge_bit(kernels::FilterEdge::kShadow)),
       static_cast<kernels::SampleMark>(51U << kernels::kWeightShift | edge_bit(kernels::FilterEdge::kReflection))});
  for (const char* program : {"reconstruct", "reconstruct:sraa"}) {
    const std::vector<DebugPicture> pictures = debug_pictures(kernels::parse_program(program), frame, 3, 1);
    EXPECT_EQ(picture_of(pictures, "weights"), (std::vector<Colour>{{255, 255, 255}, {0, 0, 0}, {51, 51, 51}}));
    const std::vector<Colour> shadows = picture_of(pictures, "edges-shadow");
    ASSERT_EQ(shadows.size(), 3U);
    EXPECT_EQ(shadows[1], (Colour{255, 255, 255}));
    EXPECT_LT(shadows[0][0], 128);
    EXPECT_EQ(picture_of(pictures, "edges-reflection").size(), 3U);
    EXPECT_TRUE(picture_of(pictures, "edges-depth").empty()) << "there are none";
    EXPECT_EQ(pictures.size(), 3U);
  }
}

TEST(RasterPictures, ShowOverdrawInsideOfQuads) {
  const traces::Scene scene = traces::open_scene("cornell");
  const traces::MemoryImage image = traces::build_memory_image(scene, {}, 1);
  kernels::RenderConfig render;
  render.width = 63;
  render.height = 31;
  render.tile = 8;
  const std::vector<DebugPicture> pictures = raster_pictures(image, scene.cameras.front(), render);
  ASSERT_EQ(pictures.size(), 2U);
  EXPECT_EQ(pictures[0].name, "overdraw");
  EXPECT_EQ(pictures[1].name, "quads");
  std::size_t seen = 0;
  for (std::size_t i = 0; i < std::size_t{63} * 31; ++i) {
    const auto is_black = [&](const DebugPicture& p) {
      return p.rgb.at(3 * i) == 0 && p.rgb.at(3 * i + 1) == 0 && p.rgb.at(3 * i + 2) == 0;
    };
    seen += !is_black(pictures[0]);
    if (!is_black(pictures[0])) {
      EXPECT_FALSE(is_black(pictures[1])) << "what covers a pixel covers its quad";
    }
  }
  EXPECT_GT(seen, std::size_t{63} * 31 / 2);
}

}  // namespace

}  // namespace tools
