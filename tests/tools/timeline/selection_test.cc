#include <set>

#include <gtest/gtest.h>

#include "shader_kernels/programs/program_spec.h"
#include "sim/error.h"
#include "tests/tools/tiles/itemised.h"
#include "tools/tiles/tile_energy.h"
#include "tools/timeline/timeline.h"

namespace tools::test {
namespace {

using Rows = std::vector<std::size_t>;

/// Returns tiles of 16 x 8 pixels, two per row. A second pass visits the third tile again.
TileFrame four_tiles() {
  return {0,
          {{"x", "pixels", false, {0, 16, 0, 16, 0}},
           {"y", "pixels", false, {0, 0, 8, 8, 8}},
           {"width", "pixels", false, {16, 16, 16, 16, 16}},
           {"height", "pixels", false, {8, 8, 8, 8, 8}},
           {"dispatched", "T&I cycles", false, {0, 5, 10, 15, 90}},
           {"finished", "T&I cycles", false, {20, 35, 30, 45, 91}}}};
}

Rows selected(const std::string& asked) { return selected_tiles(parse_timeline(asked), four_tiles()); }

TEST(TimelineSelection, NamesTilesByPlaceAndByTime) {
  EXPECT_EQ(selected("all"), (Rows{0, 1, 2, 3, 4}));
  EXPECT_EQ(selected("slowest:2"), (Rows{1, 3})) << "30 cycles each: the earlier first";
  EXPECT_EQ(selected("slowest:99"), (Rows{1, 3, 0, 2, 4}));
  EXPECT_EQ(selected("tile:1,0"), (Rows{1}));
  EXPECT_EQ(selected("tile:0,1"), (Rows{2, 4})) << "in both passes";
  EXPECT_EQ(selected("pixel:15,7"), (Rows{0}));
  EXPECT_EQ(selected("pixel:16,8"), (Rows{3}));
}

TEST(TimelineSelection, RefusesAllElse) {
  for (const char* bad : {"", "slowest", "slowest:", "slowest:0", "slowest:-1", "slowest:2x", "tile:1", "tile:1,",
                          "tile:1,2,3", "pixel:a,b", "ALL", "tile:1;2", "slowest:99999999999"}) {
    EXPECT_THROW(parse_timeline(bad), sim::InputError) << bad;
  }
  EXPECT_THROW(selected("tile:2,0"), sim::InputError);
  EXPECT_THROW(selected("pixel:0,16"), sim::InputError);
}

/// Returns the number of distinct values of a column.
std::size_t distinct(const std::vector<double>& column) {
  return std::set<double>(column.begin(), column.end()).size();
}

void expect_known(const std::string& program, const std::vector<std::string>& sets) {
  std::vector<std::string> all = {"render.tile=16", "scene.triangles=100"};
  all.insert(all.end(), sets.begin(), sets.end());
  const Inputs inputs = small_inputs(all);
  const TileFrame tiles = compute_tile_table(itemised(inputs, program.c_str()), inputs.config, 0);
  const kernels::TileGridSize counts = tile_grid_size(inputs, kernels::parse_program(program));
  EXPECT_EQ(counts.columns, distinct(tiles.at("x"))) << program;
  EXPECT_EQ(counts.rows, distinct(tiles.at("y"))) << program;
  EXPECT_NE(counts.columns, counts.rows) << program;
}

TEST(TimelineSelection, KnowsBeforeTheFrameWhichTilesThereAre) {
  for (const std::string& name : kernels::program_names()) {
    for (const char* primary : {"rays", "raster"}) expect_known(name, {std::string("render.primary=") + primary});
  }
  expect_known("full:1", {"render.effects=occlusion", "render.effect_rate=half"});
}

}  // namespace
}  // namespace tools::test
