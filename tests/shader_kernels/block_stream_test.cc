#include "block_stream.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include <gtest/gtest.h>

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

}  // namespace
}  // namespace kernels
