#include <vector>

#include <gtest/gtest.h>

#include "block_harness.h"
#include "tests/param_name.h"

// Tests of rate control: the block sides of tiles over several frames.

namespace kernels {
namespace {

MultirateConfig controlled(RateControl control = RateControl::kHysteresis) {
  MultirateConfig config;
  config.rate_control = control;
  return config;
}

/// Returns a frame whose tiles have the given fractions of similar samples.
Sampling frame_of(std::vector<float> similar) {
  Sampling frame;
  frame.similar = std::move(similar);
  return frame;
}

/// Returns the block sides of a tile, frame by frame, if its fraction of similar samples depends only on its block
/// side.
std::vector<std::uint32_t> blocks(const MultirateConfig& config, float at_two, float at_four, int frames) {
  RateMap rates(config);
  std::vector<std::uint32_t> out;
  for (int frame = 0; frame < frames; ++frame) {
    out.push_back(rates.block_side(0));
    rates.update_rates(frame_of({out.back() == RateMap::kCoarse ? at_four : at_two}));
  }
  return out;
}

TEST(RateMap, WithoutControlNothingChanges) {
  MultirateConfig config = controlled(RateControl::kOff);
  config.block = 3;
  EXPECT_EQ(blocks(config, 1, 1, 5), (std::vector<std::uint32_t>{3, 3, 3, 3, 3}));
}

TEST(RateMap, RisesFromTheUpperThreshold) {
  EXPECT_EQ(blocks(controlled(), 0.95F, 1, 3), (std::vector<std::uint32_t>{2, 4, 4}));
  EXPECT_EQ(blocks(controlled(), 0.9499F, 1, 3), (std::vector<std::uint32_t>{2, 2, 2}));
}

TEST(RateMap, StaysHighDownToTheLowerThreshold) {
  EXPECT_EQ(blocks(controlled(), 1, 0.901F, 5), (std::vector<std::uint32_t>{2, 4, 4, 4, 4}));
  EXPECT_EQ(blocks(controlled(), 1, 0.899F, 3), (std::vector<std::uint32_t>{2, 4, 2}));
}

TEST(RateMap, HoldsAfterAFall) {
  MultirateConfig config = controlled();
  config.rate_hold = 3;
  EXPECT_EQ(blocks(config, 1, 0, 8), (std::vector<std::uint32_t>{2, 4, 2, 2, 2, 2, 4, 2}));
}

TEST(RateMap, AlternateTakesTheThresholdsInTurn) {
  // 0.92 is between the thresholds, so that it suffices only in frames 1, 3, 5 ...
  MultirateConfig config = controlled(RateControl::kAlternate);
  config.rate_hold = 0;
  EXPECT_EQ(blocks(config, 0.92F, 0.92F, 6), (std::vector<std::uint32_t>{2, 2, 4, 2, 4, 2}));
}

TEST(RateMap, TilesAreIndependent) {
  RateMap rates(controlled());
  rates.update_rates(frame_of({1, 0, 0.95F, 0.94F}));
  EXPECT_EQ(rates.block_side(0), 4U);
  EXPECT_EQ(rates.block_side(1), 2U);
  EXPECT_EQ(rates.block_side(2), 4U);
  EXPECT_EQ(rates.block_side(3), 2U);
}

TEST(RateMap, AStaticViewChangesAtMostOnceUpAndOnceDownInAnyEightFrames) {
  for (const RateControl control : {RateControl::kHysteresis, RateControl::kAlternate}) {
    for (int two = 80; two <= 100; ++two) {
      for (int four = 80; four <= 100; ++four) {
        const auto of = blocks(controlled(control), static_cast<float>(two) / 100, static_cast<float>(four) / 100, 100);
        for (std::size_t first = 0; first + 8 <= of.size(); ++first) {
          int up = 0, down = 0;
          for (std::size_t i = first + 1; i < first + 8; ++i) {
            up += of[i] > of[i - 1] ? 1 : 0;
            down += of[i] < of[i - 1] ? 1 : 0;
          }
          ASSERT_LE(up, 1) << two << ' ' << four << ", from frame " << first;
          ASSERT_LE(down, 1) << two << ' ' << four << ", from frame " << first;
        }
      }
    }
  }
}

/// Tests on a frame whose tiles have block side 2 or 4, by the bits of the parameter.
class MixedRates : public testing::TestWithParam<std::uint64_t> {
 protected:
  static constexpr std::uint32_t kWidth = 75, kHeight = 41;
  const Stage stage_{traces::open_scene("cornell")};
  const RenderConfig render_ = small(kWidth, kHeight);

  RateMap rates(std::uint32_t grid) const {
    const SampleTiles tiles(kWidth, kHeight, grid, render_.tile, RateMap::kCoarse);
    std::vector<float> similar(tiles.tile_count());
    for (std::uint32_t i = 0; i < tiles.tile_count(); ++i) {
      similar[i] = GetParam() >> (i % tiles.tiles_across() + i / tiles.tiles_across() * 7) % 64 & 1U ? 1.0F : 0.0F;
    }
    RateMap map(controlled());
    map.update_rates(frame_of(similar));
    return map;
  }
};
INSTANTIATE_TEST_SUITE_P(Patterns, MixedRates,
                         testing::Values(0x5555555555555555U, 0x3a5c96f0e17d2b84U, 0xc3c3a5a50f0f9669U, 0x1U, 0U),
                         ::test::ParamName());

TEST_P(MixedRates, ThePictureDoesNotDependOnWhichTileTracesTheHalo) {
  for (const std::uint32_t grid : {1U, 2U}) {
    const RateMap map = rates(grid);
    MultirateConfig config = controlled();
    const Sampled reload = stage_.multirate(render_, config, grid, false, &map);
    config.halo = Halo::kRetrace;
    const Sampled retrace = stage_.multirate(render_, config, grid, false, &map);
    EXPECT_EQ(reload.rgb, retrace.rgb);
    EXPECT_EQ(reload.marks, retrace.marks);
    EXPECT_EQ(reload.sampling.failed, retrace.sampling.failed);
    EXPECT_EQ(reload.sampling.traced - reload.sampling.halo, retrace.sampling.traced - retrace.sampling.halo);
    EXPECT_LE(reload.sampling.halo, retrace.sampling.halo);
  }
}

TEST_P(MixedRates, ReferencesAreThoseOfEachTilesBlocks) {
  const RateMap map = rates(1);
  const Sampled run = stage_.multirate(render_, controlled(), 1, false, &map);
  const SampleTiles tiles(kWidth, kHeight, 1, render_.tile, RateMap::kCoarse);
  for (std::uint32_t y = 0; y < kHeight; ++y) {
    for (std::uint32_t x = 0; x < kWidth; ++x) {
      const std::uint32_t tile = y / tiles.tile_side() * tiles.tiles_across() + x / tiles.tile_side();
      const std::uint32_t block = map.block_side(tile);
      EXPECT_EQ(run.sampling.blocks[tile], block);
      const bool is_reference = x % block == block - 1 && y % block == block - 1;
      EXPECT_EQ((run.mark(x, y) & kReferenceMark) != 0, is_reference) << x << ' ' << y;
    }
  }
}

TEST_P(MixedRates, WithoutSimilarSamplesItIsFullAtAnyRate) {
  const RateMap map = rates(2);
  MultirateConfig config = controlled();
  config.normal = 2;
  EXPECT_EQ(stage_.multirate(render_, config, 2, false, &map).rgb, stage_.full(render_, 4).rgb);
}

TEST_P(MixedRates, EveryTileReadsItsRateAndWritesItsResult) {
  const RateMap map = rates(1);
  const SampleTiles tiles(kWidth, kHeight, 1, render_.tile, RateMap::kCoarse);
  for (const traces::TileWork& work : stage_.multirate(render_, controlled(), 1, true, &map).works) {
    std::uint32_t read = 0, written = 0;
    for (const traces::WorkNode& node : work.nodes) {
      if (node.kind != traces::WorkNode::Kind::kTransfer || node.region != traces::Region::kRates) continue;
      (node.to_memory ? written : read) += node.items;
      EXPECT_TRUE(!node.to_memory || node.offset == work.tile);
    }
    const SampleTile at = tiles.sample_tile(work.tile);
    EXPECT_EQ(read, 1U + (at.has_left ? 1 : 0) + (at.has_above ? 1 : 0))
        << "its own, and those of the tiles that its halo is of";
    EXPECT_EQ(written, 1U);
  }
  for (const traces::TileWork& work : stage_.multirate(render_, {}, 1, true).works) {
    for (const traces::WorkNode& node : work.nodes) EXPECT_NE(node.region, traces::Region::kRates);
  }
}

TEST(RateMap, AFlatSceneChangesToCoarseBlocksAndTracesLess) {
  traces::Scene scene = empty_scene();
  add_wall(scene, 0, 100, {});
  const Stage stage(scene, traces::look_at("c", {0, 0, 4}, {0, 0, 0}, 0.5F));
  RateMap rates(controlled());
  const Sampled first = stage.multirate(small(64, 64), controlled(), 1, false, &rates);
  rates.update_rates(first.sampling);
  const Sampled second = stage.multirate(small(64, 64), controlled(), 1, false, &rates);
  EXPECT_EQ(second.sampling.blocks[5], 4) << "a tile within the picture";
  EXPECT_LT(second.sampling.traced * 2, first.sampling.traced);
}

}  // namespace
}  // namespace kernels
