#include "block_stream.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "block_harness.h"
#include "shader_kernels/catalogue.h"
#include "shader_kernels/programs/programs.h"
#include "showcase.h"

// Tests of the work recorded by programs that sample in blocks: dependencies between tiles, transfers, idle items.

namespace kernels {
namespace {

using traces::Edge;
using traces::Region;
using traces::WorkNode;

INSTANTIATE_TEST_SUITE_P(Programs, BlockStream, testing::Values("multirate:under", "multirate:super", "undersample"),
                         [](const auto& i) {
                           std::string name = i.param;
                           std::ranges::replace(name, ':', '_');
                           return name;
                         });

TEST_P(BlockStream, NodesHaveItemsEdgesPointDownAndEveryBatchOfRaysIsRead) {
  for (const Streams streams : {Streams::kCompacted, Streams::kDivergent}) {
    render_.streams = streams;
    for_each_scene([&](const traces::Scene& scene) {
      for (const traces::TileWork& work : record(scene).works) {
        std::set<std::uint32_t> batches;
        for (std::uint32_t n = 0; n < work.nodes.size(); ++n) {
          const WorkNode& node = work.nodes[n];
          EXPECT_GT(node.items, 0U);
          if (node.kind == WorkNode::Kind::kRays) batches.insert(n);
          for (const Edge& edge : node.inputs) {
            ASSERT_LT(edge.node, n);
            batches.erase(edge.node);
            if (edge.kind == Edge::Kind::kEach && node.sources == WorkNode::kNone) {
              EXPECT_EQ(node.items, work.nodes[edge.node].items) << kernel(node);
            }
          }
        }
        EXPECT_TRUE(batches.empty());
        EXPECT_EQ(work.nodes.empty() ? 0U : work.access_begin.back(), work.accesses.size());
      }
    });
  }
}

TEST_P(BlockStream, NoWaveHasMoreRaysThanTheProgramRequires) {
  std::uint32_t most = 0;
  for_each_scene([&](const traces::Scene& scene) {
    const Recorded recorded = record(scene);
    const FrameRequirements& needs = recorded.requirements;
    ASSERT_GT(needs.wave_samples, 0U);
    ASSERT_LT(needs.wave_samples, needs.tile_samples);
    EXPECT_EQ(needs.pass_attribute_bytes != 0, recorded.works.size() > recorded.count) << "what scans keep";
    for (const traces::TileWork& work : recorded.works) {
      for (const WorkNode& node : work.nodes) {
        if (node.kind == WorkNode::Kind::kRays) most = std::max(most, node.items);
      }
      EXPECT_LE(most, needs.wave_samples);
    }
  });
  EXPECT_GT(most, 0U);
}

TEST_P(BlockStream, TilesThatRetraceTheHaloNeitherWaitNorRead) {
  programs_.undersample.correction = Correction::kOff;
  set({Halo::kRetrace, AttributeStorage::kTile});
  for_each_scene([&](const traces::Scene& scene) {
    std::uint32_t tile_index = 0;
    for (const traces::TileWork& work : record(scene).works) {
      EXPECT_EQ(work.tile, tile_index++) << "row by row";
      EXPECT_TRUE(work.imports.empty());
      EXPECT_FALSE(work.after_all);
      for (const WorkNode& node : work.nodes) EXPECT_FALSE(moves(node, Region::kSamples));
    }
  });
}

TEST_P(BlockStream, TransfersStayWithinTheirRegions) {
  for (const AttributeStorage storage : {AttributeStorage::kTile, AttributeStorage::kDram}) {
    set({Halo::kReload, storage});
    for_each_scene([&](const traces::Scene& scene) {
      const Recorded r = record(scene);
      for (const traces::TileWork& work : r.works) {
        for (const WorkNode& node : work.nodes) {
          if (node.kind != WorkNode::Kind::kTransfer) continue;
          EXPECT_LE(node.offset + node.items, r.requirements.region_bytes[static_cast<std::size_t>(node.region)])
              << "tile " << work.tile << " of " << r.count << ", region " << static_cast<int>(node.region);
        }
      }
    });
  }
}

TEST_P(BlockStream, AttributesInMemoryAreWrittenAndReadBackOnceForEachCheck) {
  const auto moved = [](const traces::TileWork& work) {
    std::array<std::uint64_t, 2> bytes{};
    for (const WorkNode& node : work.nodes) {
      if (moves(node, Region::kSamples)) bytes[node.to_memory ? 1 : 0] += node.items;
    }
    return bytes;
  };
  const traces::Scene scene = traces::open_scene("cornell");
  const Recorded tile = record(scene);
  set({Halo::kReload, AttributeStorage::kDram});
  const Recorded dram = record(scene);
  EXPECT_GT(tile.requirements.attribute_bytes, 0U);
  EXPECT_EQ(dram.requirements.attribute_bytes, 0U);
  ASSERT_EQ(tile.works.size(), dram.works.size());
  const auto side = static_cast<std::uint32_t>(std::lround(std::sqrt(tile.requirements.tile_samples)));
  for (std::size_t i = 0; i < tile.works.size(); ++i) {
    const auto [read, written] = moved(tile.works[i]);
    const auto [dram_read, dram_written] = moved(dram.works[i]);
    const std::uint32_t index = tile.works[i].tile;
    std::uint64_t more_written = 0, more_read = 0;
    if (index < tile.count) {
      const std::uint32_t width = std::min(side, kWidth * grid_ - index % tile.across * side);
      const std::uint32_t height = std::min(side, kHeight * grid_ - index / tile.across * side);
      const std::uint32_t rows = height / 2, columns = width / 2;
      const std::uint32_t beside = rows * (width - columns);
      more_written = std::uint64_t{record_bytes()} * (rows * columns + beside);
      more_read = std::uint64_t{record_bytes()} * (rows * columns + (beside != 0 ? rows * width : 0));
    }
    EXPECT_EQ(dram_read - read, more_read) << "tile " << index;
    EXPECT_EQ(dram_written - written, more_written) << "tile " << index;
  }
}

TEST_P(BlockStream, ItemsIdleOnlyInDivergentKernelsWhichRunOverAllItems) {
  for (const Streams streams : {Streams::kCompacted, Streams::kDivergent}) {
    render_.streams = streams;
    const bool diverges = streams == Streams::kDivergent;
    for_each_scene([&](const traces::Scene& scene) {
      std::uint64_t idle = 0;
      const Recorded r = record(scene);
      for (const traces::TileWork& work : r.works) {
        std::uint32_t lanes = 0;
        for (const WorkNode& node : work.nodes) {
          idle += node.idle;
          const std::string_view name = kernel(node);
          if (name.starts_with("check_") || name == "list_samples" || name.starts_with("find_suspects")) {
            lanes = node.items;
            EXPECT_EQ(node.idle, 0U) << name << ": an inspector sees every item";
          } else if (work.tile < r.count && (name.starts_with("interpolate_") || name == "generate_listed_rays")) {
            EXPECT_EQ(node.items + node.idle, diverges ? lanes : node.items) << name;
          }
        }
      }
      EXPECT_EQ(idle != 0, diverges);
    });
  }
}

TEST_P(BlockStream, EverySampleIsGeneratedCheckedAndAveragedOnce) {
  render_.fusion = Fusion::kOff;  // one launch per step
  for_each_scene([&](const traces::Scene& scene) {
    const Recorded r = record(scene);
    for (const traces::TileWork& work : r.works) {
      if (work.tile >= r.count) continue;
      std::map<std::string_view, std::uint64_t> items;
      std::uint64_t picture = 0, checked = 0, interpolated = 0;
      for (const WorkNode& node : work.nodes) {
        const std::string_view name = kernel(node);
        items[name] += node.items;
        if (name.starts_with("check_")) checked += node.items;
        if (name.starts_with("interpolate_")) interpolated += node.items;
        if (moves(node, Region::kPicture)) picture += node.items;
      }
      EXPECT_EQ(items["average_samples"], work.samples);
      EXPECT_EQ(items["pack_colour"] * grid_ * grid_, work.samples);
      EXPECT_EQ(picture, items["pack_colour"] * kPixelBytes);
      EXPECT_EQ(items["generate_listed_rays"] + interpolated, items["list_samples"] + checked)
          << "all that are listed or checked, of this tile and of its halo";
    }
  });
}

// Tests of programs that sample in blocks: which borders of other tiles a tile reads, and which launches wait for them.

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

// Tests that tile size, halo and threads change no bit of the picture of programs that sample in blocks.

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
