#include <gtest/gtest.h>

#include "tools/tiles/tile_energy.h"

namespace tools::test {
namespace {

std::vector<hw::TileAccount> tiles() {
  return {{.core = 0, .dispatched = 0, .finished = 10},
          {.core = 0, .dispatched = 5, .finished = 15},
          {.core = 1, .dispatched = 5, .finished = 10}};
}

TEST(TileTimeShares, IsSharedByThoseWhoAreThere) {
  const TileTimeShares of_core = tile_time_shares(tiles(), 20, 0);
  EXPECT_DOUBLE_EQ(of_core.tiles[0], 7.5 / 20) << "five alone, half of five";
  EXPECT_DOUBLE_EQ(of_core.tiles[1], 7.5 / 20);
  EXPECT_EQ(of_core.tiles[2], 0) << "it is elsewhere";
  EXPECT_DOUBLE_EQ(of_core.rest, 5.0 / 20);
}

TEST(TileTimeShares, OfAllCoresTogetherIsTheWholeTime) {
  const TileTimeShares all = tile_time_shares(tiles(), 20, {});
  EXPECT_DOUBLE_EQ(all.tiles[0], (5 + 5 / 3.0) / 20);
  EXPECT_DOUBLE_EQ(all.tiles[1], (5 + 5 / 3.0) / 20);
  EXPECT_DOUBLE_EQ(all.tiles[2], 5 / 3.0 / 20);
  EXPECT_DOUBLE_EQ(all.tiles[0] + all.tiles[1] + all.tiles[2] + all.rest, 1);
}

TEST(TileTimeShares, WithoutTilesAreAllRest) { EXPECT_EQ(tile_time_shares({}, 20, {}).rest, 1); }

}  // namespace
}  // namespace tools::test
