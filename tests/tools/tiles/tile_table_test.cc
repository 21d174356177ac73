#include "tools/tiles/tile_table.h"

#include <gtest/gtest.h>

#include "sim/error.h"
#include "tests/temp_folder.h"

namespace tools::test {
namespace {

TileTable some_table() {
  TileFrame frame{7,
                  {{"tile", "", false, {1, 0}}, {"steps", "steps", true, {4, 9007199254740991}, 3, 9007199254740998}}};
  frame.columns.push_back({"energy_mj_low", "mJ", true, {0.1, 1e-17}, 0.30000000000000004, 0.4});
  return {{frame, {8, {{"tile", "", false, {}}}}}};
}

TEST(TileTable, ReadsBackWhatItWrote) {
  const ::test::TempFolder folder;
  const TileTable table = some_table();
  folder.write("tiles.json", tiles_text(table));
  const TileTable back = load_tiles(folder.path());
  EXPECT_EQ(tiles_text(back), tiles_text(table));
  ASSERT_EQ(back.frames.size(), 2U);
  EXPECT_EQ(back.frames[0].frame, 7U);
  EXPECT_EQ(back.frames[0].at("steps"), (std::vector<double>{4, 9007199254740991}));
  EXPECT_EQ(back.frames[0].find("energy_mj_low")->rest, 0.30000000000000004);
  EXPECT_EQ(back.frames[0].find("energy_mj_low")->unit, "mJ");
  EXPECT_FALSE(back.frames[0].find("tile")->is_sum);
  EXPECT_EQ(back.frames[0].find("steps_of_others"), nullptr);
}

std::string complaint(const std::string& text) {
  const ::test::TempFolder folder;
  folder.write("tiles.json", text);
  try {
    load_tiles(folder.path() / "tiles.json");
  } catch (const sim::InputError& error) {
    return error.what();
  }
  return {};
}

TEST(TileTable, RefusesOtherFilesByName) {
  const std::string good = tiles_text(some_table());
  EXPECT_EQ(complaint(good), "");
  for (const std::string& bad :
       {std::string("{"), std::string("[]"), std::string(10000, '['), std::string(R"({"schema": "raywatt-tiles/2"})"),
        std::string(R"({"schema": "raywatt-tiles/1", "units": {}, "frames": [{"frame": 0}]})")}) {
    EXPECT_NE(complaint(bad).find("tiles.json: "), std::string::npos) << bad;
  }
  std::string uneven = good;
  uneven.replace(uneven.find("[1,0]"), 5, "[1]");
  EXPECT_NE(complaint(uneven).find("frame 7: column 'steps' has another length"), std::string::npos);
  std::string huge = good;
  huge.replace(huge.find("\"frame\": 7"), 10, "\"frame\": 1e300");
  EXPECT_NE(complaint(huge).find("tiles.json: the number 'frame'"), std::string::npos) << huge;
}

}  // namespace
}  // namespace tools::test
