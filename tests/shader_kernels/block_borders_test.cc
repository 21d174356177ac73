#include <algorithm>
#include <array>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "block_stream.h"

// Tests of programs that sample in blocks: which borders of other tiles a tile reads, and which launches wait for them.

namespace kernels {
namespace {

class BlockBorders : public BlockStream {};
INSTANTIATE_TEST_SUITE_P(Programs, BlockBorders, testing::Values("multirate:under", "multirate:super", "undersample"),
                         [](const auto& i) {
                           std::string name = i.param;
                           std::ranges::replace(name, ':', '_');
                           return name;
                         });

TEST_P(BlockBorders, TilesFollowThoseWhoseBordersTheyImport) {
  for_each_scene([&](const traces::Scene& scene) {
    const Recorded r = record(scene);
    std::set<std::uint32_t> before;
    for (std::size_t tile_index = 0; tile_index < r.works.size(); ++tile_index) {
      const traces::TileWork& work = r.works[tile_index];
      EXPECT_EQ(work.after_all, tile_index != 0 && tile_index % r.count == 0);
      std::set<std::uint32_t> of;
      for (const traces::Border& border : work.imports) {
        EXPECT_TRUE(before.contains(border.tile)) << work.tile << " of " << border.tile;
        of.insert(border.tile);
      }
      EXPECT_TRUE(before.insert(work.tile).second) << "each once";
      if (work.tile >= r.count) continue;
      std::set<std::uint32_t> neighbours;
      if (work.tile % r.across != 0) neighbours.insert(work.tile - 1);
      if (work.tile >= r.across) neighbours.insert(work.tile - r.across);
      EXPECT_EQ(of, neighbours);
    }
    EXPECT_EQ(before.size(), r.works.size());
    EXPECT_EQ(*before.rbegin(), r.works.size() - 1);
  });
}

TEST_P(BlockBorders, AScanImportsFromThePreviousTile) {
  if (spec_.kind != ProgramSpec::Kind::kUndersample) GTEST_SKIP() << "has none";
  const Recorded r = record(traces::open_scene("cornell"));
  ASSERT_EQ(r.works.size(), 5 * r.count);
  for (const traces::TileWork& work : r.works) {
    if (work.tile < r.count) continue;
    const std::uint32_t scan = work.tile / r.count - 1, tile = work.tile % r.count;
    const std::uint32_t x = tile % r.across, y = tile / r.across;
    const std::array<std::pair<bool, int>, 4> behind = {{{x > 0, -1},
                                                         {x + 1 < r.across, 1},
                                                         {y > 0, -static_cast<int>(r.across)},
                                                         {tile + r.across < r.count, static_cast<int>(r.across)}}};
    std::vector<traces::Border> expected;
    if (behind[scan].first) {
      expected.push_back({static_cast<std::uint32_t>(static_cast<int>(work.tile) + behind[scan].second), 0});
    }
    EXPECT_EQ(work.imports, expected) << "scan " << scan << ", tile " << tile;
  }
}

TEST_P(BlockBorders, BytesReadFromOtherTilesWereWrittenByThem) {
  for_each_scene([&](const traces::Scene& scene) {
    programs_.undersample.correction = Correction::kOff;
    using Range = std::pair<std::uint64_t, std::uint64_t>;
    std::vector<Range> all;
    std::map<std::pair<std::uint32_t, std::uint32_t>, Range> borders;  // key: tile, number of the border
    std::uint64_t imports = 0;
    for (const traces::TileWork& work : record(scene).works) {
      for (const WorkNode& node : work.nodes) {
        if (!moves(node, Region::kSamples)) continue;
        const Range range{node.offset, node.offset + node.items};
        if (node.to_memory) {
          EXPECT_FALSE(node.inputs.empty()) << "what is written has been made";
          all.push_back(range);
          EXPECT_TRUE(borders.emplace(std::pair(work.tile, node.border), range).second) << "each once";
          continue;
        }
        ++imports;
        ASSERT_LT(node.border, work.imports.size());
        const auto [tile, number] = work.imports[node.border];
        ASSERT_TRUE(borders.contains({tile, number})) << "tile " << work.tile << " of " << tile;
        const Range& border = borders.at({tile, number});
        EXPECT_TRUE(border.first <= range.first && range.second <= border.second) << "tile " << work.tile;
      }
    }
    EXPECT_GT(imports, 0U);
    std::ranges::sort(all);
    for (std::size_t i = 1; i < all.size(); ++i) EXPECT_LE(all[i - 1].second, all[i].first) << "no two share bytes";
  });
}

/// Returns the numbers of the borders that node `n` of a tile waits for, directly or through other nodes.
std::set<std::uint32_t> borders_behind(const traces::TileWork& work, std::uint32_t n) {
  std::set<std::uint32_t> nodes = {n}, borders;
  for (std::uint32_t i = n + 1; i-- > 0;) {
    if (!nodes.contains(i)) continue;
    const WorkNode& node = work.nodes[i];
    if (node.kind == WorkNode::Kind::kTransfer && !node.to_memory && node.border != WorkNode::kNone) {
      borders.insert(work.imports[node.border].number);
    }
    for (const Edge& edge : node.inputs) nodes.insert(edge.node);
  }
  return borders;
}

TEST_P(BlockBorders, NoBorderWaitsForAWholeRowOfTiles) {
  programs_.undersample.correction = Correction::kOff;
  for_each_scene([&](const traces::Scene& scene) {
    std::uint32_t lower = 0;
    for (const traces::TileWork& work : record(scene).works) {
      for (std::uint32_t n = 0; n < work.nodes.size(); ++n) {
        const WorkNode& node = work.nodes[n];
        if (!moves(node, Region::kSamples) || !node.to_memory) continue;
        const std::set<std::uint32_t> behind = borders_behind(work, n);
        if (node.border == kRightBorder) {
          EXPECT_TRUE(behind.empty()) << "references need no neighbour";
        } else {
          EXPECT_FALSE(behind.contains(kLowerBorder)) << "the last row is there before the tile's second check";
          lower += behind.contains(kRightBorder) ? 1 : 0;
        }
      }
    }
    EXPECT_GT(lower, 0U);
  });
}

}  // namespace
}  // namespace kernels
