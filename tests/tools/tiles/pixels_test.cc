#include <algorithm>
#include <cstdint>
#include <string>

#include <gtest/gtest.h>

#include "tests/temp_folder.h"
#include "tests/tools/tiles/itemised.h"
#include "tools/tiles/heat_map.h"
#include "tools/tiles/tile_energy.h"

// Tests that the work of rays is completely attributed to the right pixels.

namespace tools::test {
namespace {

using kernels::PixelWork;

constexpr std::uint32_t kWidth = 48, kHeight = 24;

struct Sums {
  std::uint64_t rays = 0, steps = 0, tests = 0;
  void add(const PixelWork& pixel) {
    rays += pixel.rays;
    steps += pixel.steps;
    tests += pixel.tests;
  }
  friend bool operator==(const Sums&, const Sums&) = default;
};

Sums sums(const std::vector<PixelWork>& pixels) {
  Sums all;
  for (const PixelWork& pixel : pixels) all.add(pixel);
  return all;
}

std::uint64_t total(const TileFrame& frame, const char* column) {
  return static_cast<std::uint64_t>(frame.find(column)->total);
}

class PixelsOf : public testing::TestWithParam<const char*> {
 protected:
  const Inputs inputs_ = small_inputs({"render.tile=16", "supersample.propagate=1"});
};
INSTANTIATE_TEST_SUITE_P(Programs, PixelsOf,
                         testing::Values("full:1", "full:4", "multirate:under", "multirate:super", "undersample",
                                         "supersample"),
                         [](const auto& i) {
                           std::string name = i.param;
                           std::ranges::replace(name, ':', '_');
                           return name;
                         });

TEST_P(PixelsOf, EachProgramSumToItsTotalsForAnyNumberOfThreads) {
  const FrameResult s = itemised(inputs_, GetParam());
  const TileFrame frame = compute_tile_table(s, inputs_.config, 0);
  ASSERT_EQ(s.rendered.pixels.size(), std::size_t{kWidth} * kHeight);
  EXPECT_EQ(sums(s.rendered.pixels), (Sums{s.rays(), s.rendered.traversal_steps, total(frame, "tests")}));
  const FrameResult other = itemised(inputs_, GetParam(), 4);
  for (std::size_t i = 0; i < s.rendered.pixels.size(); ++i) {
    const PixelWork &a = s.rendered.pixels[i], &b = other.rendered.pixels[i];
    ASSERT_TRUE(a.rays == b.rays && a.steps == b.steps && a.tests == b.tests) << "pixel " << i;
  }
}

TEST(Pixels, OfATileSumToIt) {
  const Inputs inputs = small_inputs({"render.tile=16"});
  for (const char* program : {"full:1", "full:4"}) {
    const FrameResult s = itemised(inputs, program);
    const TileFrame frame = compute_tile_table(s, inputs.config, 0);
    for (std::size_t i = 0; i < frame.rows(); ++i) {
      Sums of_tile;
      for (double y = frame.at("y")[i]; y < frame.at("y")[i] + frame.at("height")[i]; ++y) {
        for (double x = frame.at("x")[i]; x < frame.at("x")[i] + frame.at("width")[i]; ++x) {
          of_tile.add(s.rendered.pixels[static_cast<std::size_t>(y * kWidth + x)]);
        }
      }
      EXPECT_EQ(of_tile.steps, static_cast<std::uint64_t>(frame.at("steps")[i])) << program << " tile " << i;
      EXPECT_EQ(of_tile.tests, static_cast<std::uint64_t>(frame.at("tests")[i])) << program << " tile " << i;
    }
  }
}

TEST(Pixels, HaveRaysWhereTheProgramTraced) {
  // Halo samples come from memory, so that a tile traces only its own samples.
  const Inputs inputs = small_inputs({"render.tile=16"});
  for (const char* program : {"multirate:under", "undersample"}) {
    const FrameResult s = simulate_frame(inputs, kernels::parse_program(program), 1, {.marks = true, .itemised = true});
    ASSERT_EQ(s.rendered.marks.size(), s.rendered.pixels.size());
    std::size_t untraced = 0;
    for (std::size_t i = 0; i < s.rendered.pixels.size(); ++i) {
      const bool traced = (s.rendered.marks[i] & kernels::kTracedMark) != 0;
      EXPECT_EQ(s.rendered.pixels[i].rays > 0, traced) << program << " pixel " << i % kWidth << ", " << i / kWidth;
      untraced += traced ? 0 : 1;
    }
    const bool is_sparse = program == std::string("multirate:under");
    EXPECT_GE(untraced, is_sparse ? 100U : 0U) << "there is something to tell apart";
  }
}

TEST(PixelsFile, HoldsWhatEachPixelTook) {
  const ::test::TempFolder folder;
  std::vector<PixelWork> pixels(6);
  for (std::uint32_t i = 0; i < pixels.size(); ++i) pixels[i] = {i, i, 2048 - i, 2049 + i};
  write_pixels(folder.path() / kPixelsFile, pixels, 3, 2, {});
  const traces::FloatImage image = traces::read_exr(folder.path() / kPixelsFile);
  ASSERT_EQ(image.rgb.size(), 18U);
  for (std::uint32_t i = 0; i < pixels.size(); ++i) {
    EXPECT_EQ(image.rgb[3 * i], pixels[i].rays);
    EXPECT_EQ(image.rgb[3 * i + 1], pixels[i].steps);
    EXPECT_EQ(image.rgb[3 * i + 2], pixels[i].tests) << "too large for 16 bits";
  }
}

}  // namespace
}  // namespace tools::test
