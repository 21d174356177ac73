#include <thread>

#include <gtest/gtest.h>

#include "block_harness.h"
#include "showcase.h"

// Tests that tile size, halo and threads change no bit of the picture of programs that sample in blocks.

namespace kernels {
namespace {

class Blocks : public testing::TestWithParam<const char*> {
 protected:
  static traces::Scene scene() {
    return std::string_view(GetParam()) == "showcase" ? showcase_scene() : traces::open_scene(GetParam());
  }
  const Stage stage_{scene()};

  /// Expects `b` to have the same picture, marks and counts as `a`, except for counts of halo samples.
  static void expect_same(const Sampled& b, const Sampled& a) {
    EXPECT_EQ(b.rgb, a.rgb);
    EXPECT_EQ(b.marks, a.marks);
    EXPECT_EQ(b.sampling.wanted, a.sampling.wanted);
    EXPECT_EQ(b.sampling.traced - b.sampling.halo, a.sampling.traced - a.sampling.halo);
    EXPECT_EQ(b.sampling.correction, a.sampling.correction);
    EXPECT_EQ(b.sampling.background, a.sampling.background);
    EXPECT_EQ(b.sampling.checked, a.sampling.checked);
    EXPECT_EQ(b.sampling.passed, a.sampling.passed);
    EXPECT_EQ(b.sampling.failed, a.sampling.failed);
  }

  /// Expects `run(render, adaptive)` to return the same picture for all settings that must not change it.
  static void expect_indifferent(const RenderConfig& base, auto&& run) {
    const Sampled reference = run(base, AdaptiveConfig{});
    for (const std::uint32_t tile : {8U, 16U, 32U, 33U, 128U}) {
      for (const Halo halo : {Halo::kReload, Halo::kRetrace}) {
        SCOPED_TRACE(testing::Message() << "tile " << tile << ", halo "
                                        << names_of(halo)[static_cast<std::size_t>(halo)]);
        RenderConfig render = base;
        render.tile = tile;
        expect_same(run(render, AdaptiveConfig{halo, AttributeStorage::kTile}), reference);
      }
    }
    SCOPED_TRACE("attributes in memory, divergent kernels");
    expect_same(run(base, AdaptiveConfig{Halo::kReload, AttributeStorage::kDram}), reference);
    RenderConfig divergent = base;
    divergent.streams = Streams::kDivergent;
    expect_same(run(divergent, AdaptiveConfig{}), reference);
  }
};
INSTANTIATE_TEST_SUITE_P(Scenes, Blocks, testing::Values("cornell", "showcase"),
                         [](const auto& i) { return std::string(i.param); });

constexpr std::array<std::array<std::uint32_t, 2>, 5> kSizes = {{{37, 23}, {1, 1}, {2, 1}, {3, 50}, {17, 2}}};

TEST_P(Blocks, MultirateThatFindsNothingSimilarIsFull) {
  for (const auto& [width, height] : kSizes) {
    for (const std::uint32_t grid : {1U, 2U}) {
      const Sampled full = stage_.full(small(width, height), grid * grid);
      for (const std::uint32_t block : {2U, 3U, 4U}) {
        MultirateConfig config;
        config.normal = 2;
        config.block = block;
        const Sampled blocks = stage_.multirate(small(width, height), config, grid);
        EXPECT_EQ(blocks.rgb, full.rgb) << width << 'x' << height << ", block " << block << ", grid " << grid;
        EXPECT_EQ(blocks.sampling.traced - blocks.sampling.halo, blocks.sampling.wanted);
        EXPECT_EQ(blocks.sampling.passed, 0U);
      }
    }
  }
}

TEST_P(Blocks, UndersampleThatFindsNothingSimilarIsFull) {
  for (const auto& [width, height] : kSizes) {
    for (const std::uint32_t samples : {1U, 4U, 9U}) {
      const Sampled full = stage_.full(small(width, height), samples);
      for (const std::uint32_t block : {2U, 3U, 4U}) {
        UndersampleConfig config;
        config.normal = 2;
        config.samples = samples;
        config.block = block;
        config.correction = Correction::kFour;
        const Sampled blocks = stage_.undersample(small(width, height), config);
        EXPECT_EQ(blocks.rgb, full.rgb) << width << 'x' << height << ", block " << block << ", samples " << samples;
        EXPECT_EQ(blocks.sampling.traced - blocks.sampling.halo, blocks.sampling.wanted);
        EXPECT_EQ(blocks.sampling.passed + blocks.sampling.correction, 0U);
      }
    }
  }
}

TEST_P(Blocks, AMultiratePictureDoesNotDependOnHowItIsMade) {
  for (const auto& [width, height] : kSizes) {
    for (const std::uint32_t grid : {1U, 2U}) {
      for (const std::uint32_t block : {2U, 3U, 4U}) {
        SCOPED_TRACE(testing::Message() << width << 'x' << height << ", block " << block << ", grid " << grid);
        expect_indifferent(small(width, height), [&](const RenderConfig& render, const AdaptiveConfig& adaptive) {
          MultirateConfig config{adaptive};
          config.block = block;
          return stage_.multirate(render, config, grid);
        });
      }
    }
  }
}

TEST_P(Blocks, AnUndersampledPictureDoesNotDependOnHowItIsMade) {
  for (const auto& [width, height] : kSizes) {
    for (const std::uint32_t samples : {1U, 4U}) {
      for (const std::uint32_t block : {2U, 3U, 4U}) {
        SCOPED_TRACE(testing::Message() << width << 'x' << height << ", block " << block << ", samples " << samples);
        expect_indifferent(small(width, height), [&](const RenderConfig& render, const AdaptiveConfig& adaptive) {
          UndersampleConfig config{adaptive};
          config.block = block;
          config.samples = samples;
          config.correction = Correction::kFour;
          config.neighbours = Neighbourhood::kEight;
          config.correct_shadows = true;
          return stage_.undersample(render, config);
        });
      }
    }
  }
}

TEST_P(Blocks, ManySamplesPerPixelAreFoundLikeManyPixels) {
  for (const std::uint32_t n : {2U, 4U}) {
    UndersampleConfig config;
    config.correction = Correction::kFour;
    const Sampled pixels = stage_.undersample(small(20 * n, 12 * n), config);
    config.samples = n * n;
    const Sampled samples = stage_.undersample(small(20, 12), config);
    EXPECT_EQ(samples.marks, pixels.marks) << n;
    expect_equal(samples.sampling, pixels.sampling);
  }
}

TEST_P(Blocks, TilesOfAPassMayRunOnManyThreadsInAnyOrder) {
  UndersampleConfig config;
  config.correction = Correction::kFour;
  const Sampled alone = stage_.undersample(small(64, 40), config, true);
  UndersampleProgram program(stage_.image, stage_.camera, small(64, 40), config, stage_.size(), 0);
  for (std::uint32_t begin = 0; begin < program.tiles(); begin = program.pass_end(begin)) {
    program.begin_pass(begin, stage_.tracer);
    std::vector<TileResult> tiles(program.pass_end(begin) - begin);
    std::vector<std::thread> threads;
    for (std::uint32_t first = 0; first < 3; ++first) {
      threads.emplace_back([&, first] {
        for (auto t = static_cast<std::uint32_t>(tiles.size()); t-- > 0;) {
          if (t % 3 == first) program.run_tile(begin + t, stage_.tracer, true, tiles[t]);
        }
      });
    }
    for (std::thread& thread : threads) thread.join();
    for (std::uint32_t t = 0; t < tiles.size(); ++t) {
      program.commit_tile(tiles[t]);
      EXPECT_EQ(tiles[t].work.walk, alone.works[begin + t].walk);
      EXPECT_EQ(tiles[t].work.nodes.size(), alone.works[begin + t].nodes.size());
    }
  }
  EXPECT_EQ(program.picture(), alone.rgb);
  expect_equal(program.sampling(), alone.sampling);
}

}  // namespace
}  // namespace kernels
