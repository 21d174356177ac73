#include <gtest/gtest.h>

#include "sim/error.h"
#include "sim/io/json.h"
#include "tests/tools/program.h"
#include "tools/studies/report/report.h"
#include "traces/scene/images.h"

namespace test {
namespace {

using namespace tools::pages;

/// Returns the table of two tiles of side 8 in a picture of 16x5. The second tile has two passes.
tools::TileFrame frame() {
  tools::TileFrame out;
  const auto add = [&](const char* name, std::vector<double> values) {
    out.columns.push_back({.name = name, .unit = "", .values = std::move(values)});
  };
  add("tile", {0, 1, 1});
  add("x", {0, 8, 8});
  add("y", {0, 0, 0});
  add("width", {8, 8, 8});
  add("dispatched", {0, 10, 100});
  add("finished", {7, 30, 1000});
  add("energy_mj_nominal", {1.0 / 3, 2, 3});
  return out;
}

const TileMetric& metric(const char* id) {
  return *std::ranges::find(tile_metrics(), std::string_view(id),
                            [](const TileMetric& each) { return std::string_view(each.id); });
}

TEST(TileMaps, SumTheRowsOfATile) {
  const tools::TileFrame tiles = frame();
  const TileGrid grid = tile_grid(tiles, 16, 5);
  EXPECT_EQ(grid.columns, 2U);
  EXPECT_EQ(grid.rows, 1U);
  EXPECT_EQ(tile_values(metric("cycles"), tiles, grid), (std::vector<double>{7, 20 + 900}));
  EXPECT_EQ(tile_values(metric("energy"), tiles, grid)[1], 5e6) << "nJ";
}

TEST(TileMaps, RefuseTilesOutsideThePictureAndTablesWithoutPlaces) {
  tools::TileFrame tiles = frame();
  EXPECT_THROW(tile_grid(tiles, 8, 5), sim::InputError);
  tiles.columns[1].values[0] = -1;
  EXPECT_THROW(tile_grid(tiles, 16, 5), sim::InputError);
  tiles.columns[1].values[0] = 1e300;
  EXPECT_THROW(tile_grid(tiles, 16, 5), sim::InputError);
  tiles = frame();
  tiles.columns[3].values = {0, 0, 0};
  EXPECT_THROW(tile_grid(tiles, 16, 5), sim::InputError) << "tiles without a width";
  tiles = frame();
  tiles.columns.erase(tiles.columns.begin() + 1);
  EXPECT_THROW(tile_grid(tiles, 16, 5), sim::InputError) << "a replay knows no places";
  EXPECT_THROW(tile_values(metric("steps"), frame(), tile_grid(frame(), 16, 5)), sim::InputError);
}

TEST(TileMaps, KeepWholeNumbersExactlyAndOthersInFiveDigits) {
  EXPECT_EQ(sim::json_line(rounded_for_page({123456789, -2, 0, 1.0 / 3, 123456.7})),
            "[123456789,-2,0,0.33333,123460.0]");
}

TEST(PagePictures, AreAveragedOverSquaresIfTooLarge) {
  const TempFolder folder;
  const std::vector<std::uint8_t> rgb = {10, 0, 0, 20, 0, 0, 100, 0, 5, 30, 0, 0, 40, 0, 0, 100, 0, 5};
  const auto file = folder.path() / "picture.png";
  traces::write_png(file, 3, 2, rgb);
  EXPECT_EQ(picture_as_data_url(file, 6), data_url("image/png", read_bytes(file))) << "one that fits is taken as it is";
  traces::Texture small;
  small.width = 2;
  small.height = 1;
  small.texels = {0xff000019, 0xff050064};  // mean of 10, 20, 30, 40; the right column alone
  EXPECT_EQ(picture_as_data_url(file, 5), data_url("image/png", traces::encode_png(small)));
  folder.write("text.png", "no picture");
  EXPECT_FALSE(picture_as_data_url(folder.path() / "text.png", 6));
  EXPECT_FALSE(picture_as_data_url(folder.path() / "none.png", 6));
}

}  // namespace
}  // namespace test
