#include "tools/tiles/heat_map.h"

#include <algorithm>
#include <map>
#include <numeric>

#include <gtest/gtest.h>

#include "tests/tools/tiles/itemised.h"
#include "tools/tiles/tile_energy.h"
#include "traces/scene/images.h"

// Tests that heat maps have the values of tiles.json and pixels.exr, in colours from 0 to the largest value.

namespace tools::test {
namespace {

using Rgb = std::vector<std::uint8_t>;

Rgb pixel(const DrawnMap& drawn, std::uint32_t x, std::uint32_t y) {
  const auto at = drawn.rgb.begin() + 3 * (std::ptrdiff_t{y} * drawn.width + x);
  return {at, at + 3};
}

struct HeatMapsOf : testing::TestWithParam<const char*> {
  const Inputs inputs = small_inputs({"render.tile=16"});
  const FrameResult s = itemised(inputs, GetParam());
  const TileFrame tiles = compute_tile_table(s, inputs.config, 0);
  std::map<std::string, HeatMap> maps;
  void SetUp() override {
    for (HeatMap& map : heat_maps(s, tiles, 48, 24)) maps.emplace(map.name, std::move(map));
  }
  double sum(const char* name) const {
    const std::vector<float>& values = maps.at(name).values;
    return std::accumulate(values.begin(), values.end(), 0.0);
  }
};
INSTANTIATE_TEST_SUITE_P(Programs, HeatMapsOf, testing::Values("full:1", "full:4", "supersample"),
                         [](const auto& i) { return std::string(i.param).substr(0, 4) + std::to_string(i.index); });

TEST_P(HeatMapsOf, PixelsHaveTheirOwnWork) {
  for (std::size_t i = 0; i < s.rendered.pixels.size(); ++i) {
    EXPECT_EQ(maps.at("rays").values[i], static_cast<float>(s.rendered.pixels[i].rays)) << i;
    EXPECT_EQ(maps.at("steps").values[i], static_cast<float>(s.rendered.pixels[i].steps)) << i;
    EXPECT_EQ(maps.at("tests").values[i], static_cast<float>(s.rendered.pixels[i].tests)) << i;
  }
}

TEST_P(HeatMapsOf, EnergyOfPixelsIsThatOfTiles) {
  const std::vector<double>& energy = tiles.at("energy_mj_nominal");
  const double nanojoules = 1e6 * std::accumulate(energy.begin(), energy.end(), 0.0);
  EXPECT_NEAR(sum("energy"), nanojoules, 1e-4 * nanojoules);
}

TEST_P(HeatMapsOf, TilesHaveWhatTheyTookInAllPasses) {
  for (std::uint32_t y = 0; y < 24; ++y) {
    for (std::uint32_t x = 0; x < 48; ++x) {
      double cycles = 0, srp_cycles = 0;
      for (std::size_t i = 0; i < tiles.rows(); ++i) {
        const double left = tiles.at("x")[i], top = tiles.at("y")[i];
        if (x < left || y < top || x >= left + tiles.at("width")[i] || y >= top + tiles.at("height")[i]) continue;
        cycles += tiles.at("finished")[i] - tiles.at("dispatched")[i];
        srp_cycles += tiles.at("srp_cycles")[i];
      }
      ASSERT_EQ(maps.at("cycles").values[y * 48 + x], static_cast<float>(cycles)) << x << ", " << y;
      ASSERT_EQ(maps.at("srp-cycles").values[y * 48 + x], static_cast<float>(srp_cycles)) << x << ", " << y;
    }
  }
}

TEST(HeatMap, IsDrawnFromNothingToTheMostAboveItsBar) {
  HeatMap map{"steps", "STEPS", "viridis", 300, 2, std::vector<float>(600, 0)};
  map.values[301] = 70;
  map.values[302] = 35;
  const DrawnMap drawn = draw_heat_map(map);
  const std::vector<float> scale = {0, 0.5F, 1};
  const Rgb colours = traces::apply_colour_map("viridis", scale);
  const auto colour = [&](std::ptrdiff_t i) { return Rgb(colours.begin() + 3 * i, colours.begin() + 3 * i + 3); };
  EXPECT_EQ(pixel(drawn, 0, 0), colour(0));
  EXPECT_EQ(pixel(drawn, 1, 1), colour(2));
  EXPECT_EQ(pixel(drawn, 2, 1), colour(1));
  const std::uint32_t bar = 2 + 3 + 4;
  EXPECT_EQ(pixel(drawn, 3, bar), colour(0)) << "the bar begins with nothing";
  EXPECT_EQ(pixel(drawn, drawn.width - 4, bar), colour(2)) << "and ends with the most";
  EXPECT_EQ(pixel(drawn, 1, bar), (Rgb{255, 255, 255}));
  const Rgb below(drawn.rgb.end() - std::ptrdiff_t{3} * drawn.width * (traces::kTextHeight + 3), drawn.rgb.end());
  EXPECT_GT(std::ranges::count_if(below, [](std::uint8_t value) { return value < 64; }), 60) << "a label below it";
}

TEST(HeatMap, HasTheColoursThatItsMapDefines) {
  const std::vector<float> ends = {0, 1};
  const auto near = [&](const char* map, const Rgb& wanted) {
    const Rgb colours = traces::apply_colour_map(map, ends);
    ASSERT_EQ(colours.size(), wanted.size());
    for (std::size_t i = 0; i < wanted.size(); ++i) EXPECT_NEAR(colours[i], wanted[i], 2) << map << " " << i;
  };
  near("viridis", {68, 1, 84, 253, 231, 37});
  near("turbo", {48, 18, 59, 122, 4, 3});
}

TEST(HeatMap, OfNothingIsOfOneColour) {
  const DrawnMap drawn = draw_heat_map({"rays", "RAYS", "turbo", 200, 1, std::vector<float>(200, 0)});
  EXPECT_EQ(pixel(drawn, 0, 0), pixel(drawn, 199, 0));
}

}  // namespace
}  // namespace tools::test
