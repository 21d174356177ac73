#include <gtest/gtest.h>

#include "sim/error.h"
#include "tests/traces/trace_file/tiny_tile.h"

// Tests of the encoding of accesses to regions kSamples and kBuild.

namespace traces {
namespace {

/// Returns a tile with one launch whose two items read the given words of region kSamples.
TileWork tile_that_reads(std::uint32_t first, std::uint32_t second) {
  TileWork tile;
  tile.nodes = {{.items = 2, .first = 0, .has_accesses = true, .inputs = {}}};
  tile.accesses = {Access::of_kind(Access::Kind::kStored, first), Access::of_kind(Access::Kind::kStored, second)};
  tile.access_begin = {0, 1, 2};
  return tile;
}

TEST(StoredAccess, RestoresWordsOfTheRegion) {
  const TileScope scope = test::tiny_scope();  // 512 bytes of samples
  const TileWork tile = tile_that_reads(127, 3);
  TileWork back;
  test::decode(test::encode(tile, scope.links), scope, back);
  EXPECT_TRUE(test::same(tile, back));
}

TEST(StoredAccess, RefusesWordsOutsideTheRegion) {
  const TileScope scope = test::tiny_scope();
  TileWork back;
  EXPECT_THROW(test::decode(test::encode(tile_that_reads(3, 128), scope.links), scope, back), sim::InputError);
}

TEST(StoredAccess, ReachesRecordsOfKernelsThatBuildTrees) {
  TileScope scope = test::tiny_scope();  // a line of rates
  scope.region_bytes[static_cast<std::size_t>(Region::kBuild)] = 64;
  constexpr std::uint32_t kWords = (512 + 64 + 64) / kStoredWordBytes;
  const TileWork tile = tile_that_reads(3, kWords - 1);
  TileWork back;
  test::decode(test::encode(tile, scope.links), scope, back);
  EXPECT_TRUE(test::same(tile, back));
  EXPECT_THROW(test::decode(test::encode(tile_that_reads(3, kWords), scope.links), scope, back), sim::InputError);
}

}  // namespace
}  // namespace traces
