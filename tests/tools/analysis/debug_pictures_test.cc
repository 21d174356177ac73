#include <algorithm>
#include <array>
#include <string_view>

#include <gtest/gtest.h>

#include "shader_kernels/programs/program_spec.h"
#include "tools/analysis/picture.h"

namespace tools {
namespace {

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

}  // namespace
}  // namespace tools
