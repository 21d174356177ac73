#include <algorithm>
#include <map>
#include <string_view>

#include <gtest/gtest.h>

#include "harness.h"
#include "shader_kernels/catalogue.h"
#include "showcase.h"
#include "traces/walk.h"

namespace kernels {
namespace {

using traces::Edge;
using traces::RayKind;
using traces::WorkNode;

/// Tests of the recorded work of every tile of a scene, at a low, odd resolution.
class Stream : public testing::TestWithParam<const char*> {
 protected:
  static traces::Scene scene() {
    return std::string_view(GetParam()) == "showcase" ? showcase_scene() : traces::open_scene(GetParam());
  }
  void for_each_tile(std::uint32_t samples, auto&& check, Fusion fusion = Fusion::kOn) {
    const traces::Scene scene = Stream::scene();
    const traces::MemoryImage image = traces::build_memory_image(scene);
    const traces::BvhTracer tracer(image);
    RenderConfig config = small(75, 41);
    config.fusion = fusion;
    const FullProgram program(image, scene.cameras[0], config, samples, 0);
    TileResult tile;
    for (std::uint32_t t = 0; t < program.tiles(); ++t) {
      program.run_tile(t, tracer, true, tile);
      check(tile);
    }
  }
  static std::string_view kernel(const WorkNode& node) { return kernel_catalogue()[node.kernel].name; }
};
INSTANTIATE_TEST_SUITE_P(Scenes, Stream, testing::Values("cornell", "showcase"),
                         [](const auto& i) { return std::string(i.param); });

TEST_P(Stream, EdgesPointDownAndEveryItemOfAnEachEdgeHasASource) {
  for_each_tile(4, [](const TileResult& tile) {
    const auto& nodes = tile.work.nodes;
    for (std::uint32_t n = 0; n < nodes.size(); ++n) {
      EXPECT_GT(nodes[n].items, 0U);
      for (const Edge& edge : nodes[n].inputs) {
        ASSERT_LT(edge.node, n);
        if (edge.kind == Edge::Kind::kAll) continue;
        const std::uint32_t from = nodes[edge.node].items;
        if (nodes[n].sources == WorkNode::kNone) {
          EXPECT_EQ(nodes[n].items, from);
          continue;
        }
        ASSERT_LE(nodes[n].sources + nodes[n].items, tile.work.sources.size());
        const auto first = tile.work.sources.begin() + nodes[n].sources;
        EXPECT_TRUE(std::is_sorted(first, first + nodes[n].items));
        EXPECT_LT(first[nodes[n].items - 1], from);
      }
    }
  });
}

TEST_P(Stream, RayBatchesComeFromOneLaunchAndCoverAllRaysInOrder) {
  for_each_tile(1, [](const TileResult& tile) {
    std::uint32_t first = 0;
    std::array<std::uint64_t, 4> rays{};
    for (const WorkNode& node : tile.work.nodes) {
      if (node.kind != WorkNode::Kind::kRays) continue;
      EXPECT_EQ(node.first, first);
      first += node.items;
      rays[static_cast<std::size_t>(node.ray_kind)] += node.items;
      ASSERT_EQ(node.inputs.size(), 1U);
      EXPECT_EQ(node.inputs[0].kind, Edge::Kind::kEach);
      EXPECT_EQ(tile.work.nodes[node.inputs[0].node].kind, WorkNode::Kind::kLaunch);
      // Every primary ray has its own item; other rays come from some of a launch's items.
      EXPECT_EQ(node.sources == WorkNode::kNone, node.first == 0);
    }
    EXPECT_EQ(first, tile.work.ray_begin.size());
    EXPECT_EQ(rays, tile.rays);
    EXPECT_GE(tile.rays[0], tile.work.samples);
    EXPECT_LE(tile.rays[0], tile.work.samples + tile.continued);
  });
}

TEST_P(Stream, ReadersOfABatchWaitForItAndForItsContinuedRays) {
  for_each_tile(1, [](const TileResult& tile) {
    const auto& nodes = tile.work.nodes;
    std::uint32_t last_scatter = WorkNode::kNone;
    for (std::uint32_t n = 0; n < nodes.size(); ++n) {
      if (nodes[n].kind != WorkNode::Kind::kLaunch) continue;
      const std::string_view name = kernel(nodes[n]);
      const auto waits_for = [&](auto&& wanted) {
        return std::ranges::any_of(nodes[n].inputs, [&](const Edge& e) { return wanted(e); });
      };
      const auto is_batch = [&](const Edge& e) { return nodes[e.node].kind == WorkNode::Kind::kRays; };
      if (name == "classify_hits" || name == "combine_shadow") {
        EXPECT_TRUE(waits_for(is_batch));
        if (last_scatter != WorkNode::kNone) {
          EXPECT_TRUE(waits_for([&](const Edge& e) { return e.node >= last_scatter; })) << name;
        }
        last_scatter = WorkNode::kNone;
      } else if (name.starts_with("test_") || name == "scatter_layers") {
        EXPECT_TRUE(waits_for([&](const Edge& e) { return is_batch(e) && e.kind == Edge::Kind::kAll; })) << name;
        if (name == "scatter_layers") last_scatter = n;
      }
    }
  });
}

TEST_P(Stream, EveryItemIsCountedOnce) {
  const auto check = [](const TileResult& tile) {
    std::map<std::string_view, std::uint64_t> items;
    std::uint64_t bytes = 0;
    for (const WorkNode& node : tile.work.nodes) {
      if (node.kind == WorkNode::Kind::kLaunch) items[kernel(node)] += node.items;
      if (node.kind == WorkNode::Kind::kTransfer) bytes += node.items;
    }
    EXPECT_EQ(items["generate_rays"], tile.work.samples);
    EXPECT_EQ(items["classify_hits"], items["shade_background"] + items["shade_surface"]);
    EXPECT_EQ(items["classify_surfaces"], items["shade_surface"]);
    // A ray that continues through a surface makes no new hit record.
    EXPECT_EQ(items["scatter_layers"], tile.continued);
    EXPECT_EQ(items["classify_hits"] + items["combine_shadow"] + tile.continued, tile.work.ray_begin.size());
    EXPECT_LE(items["combine_shadow"], tile.rays[1]);
    EXPECT_GE(items["shade_mirror"] + tile.continued, tile.rays[2]);
    EXPECT_GE(items["shade_glass"] + items["shade_straight"] + tile.continued, tile.rays[3]);
    EXPECT_EQ(items["average_colour"], tile.work.samples);
    EXPECT_EQ(items["pack_colour"], std::uint64_t{tile.width} * tile.height);
    EXPECT_EQ(bytes, std::uint64_t{4} * tile.width * tile.height);
    EXPECT_EQ(tile.work.nodes.back().kind, WorkNode::Kind::kTransfer);
  };
  for_each_tile(1, check, Fusion::kOff);  // one launch per step
}

TEST_P(Stream, LaunchesThatReadMemoryListTheAccessesOfEachItem) {
  for_each_tile(1, [](const TileResult& tile) {
    std::uint32_t first = 0;
    for (const WorkNode& node : tile.work.nodes) {
      if (node.kind != WorkNode::Kind::kLaunch) continue;
      const Graph& graph = kernel_catalogue()[node.kernel].graph;
      const auto loads = std::ranges::count(graph.nodes, Op::kLoadCached, &GraphNode::op);
      EXPECT_EQ(node.has_accesses, loads != 0);
      if (!node.has_accesses) continue;
      EXPECT_EQ(node.first, first);
      first += node.items;
      ASSERT_LT(first, tile.work.access_begin.size());
      for (std::uint32_t i = node.first; i < first; ++i) {
        EXPECT_EQ(tile.work.access_begin[i + 1] - tile.work.access_begin[i], loads);
      }
    }
    EXPECT_EQ(first + 1, tile.work.access_begin.size());
    EXPECT_EQ(tile.work.access_begin.back(), tile.work.accesses.size());
  });
}

TEST_P(Stream, StepsAreVisitsAndTriangleTestsOfTheWalks) {
  for_each_tile(1, [](const TileResult& tile) {
    std::uint64_t steps = 0, rays = 0;
    for (std::size_t i = 0; i < tile.work.walk.size(); ++i) {
      const std::uint32_t word = tile.work.walk[i];
      switch (traces::kind_of(word)) {
        case traces::StepKind::kVisit:
          steps += 1;
          break;
        case traces::StepKind::kLeaf:
          ++i;
          for (std::uint32_t test = 0; test < traces::count_of(word); ++test) {
            steps += static_cast<std::uint32_t>(traces::phase_of(tile.work.walk[i], test)) != 0 ? 1 : 0;
          }
          break;
        case traces::StepKind::kCull:
          break;
        case traces::StepKind::kEnd:
          rays += 1;
          break;
      }
    }
    EXPECT_EQ(steps, tile.traversal_steps);
    EXPECT_EQ(rays, tile.work.ray_begin.size());
  });
}

TEST_P(Stream, AUsedResultGivesTheSameStreamAsANewOne) {
  const traces::Scene scene = Stream::scene();
  const traces::MemoryImage image = traces::build_memory_image(scene);
  const traces::BvhTracer tracer(image);
  const FullProgram program(image, scene.cameras[0], small(64, 32), 1, 0);
  TileResult used;
  for (std::uint32_t t = 0; t < program.tiles(); ++t) {
    TileResult fresh;
    program.run_tile(t, tracer, true, fresh);
    program.run_tile(program.tiles() - 1 - t, tracer, true, used);
    program.run_tile(t, tracer, true, used);
    EXPECT_EQ(used.linear, fresh.linear);
    EXPECT_EQ(used.packed, fresh.packed);
    EXPECT_EQ(used.work.walk, fresh.work.walk);
    EXPECT_EQ(used.work.sources, fresh.work.sources);
    EXPECT_EQ(used.work.access_begin, fresh.work.access_begin);
    ASSERT_EQ(used.work.nodes.size(), fresh.work.nodes.size());
    for (std::size_t n = 0; n < fresh.work.nodes.size(); ++n) {
      EXPECT_EQ(used.work.nodes[n].items, fresh.work.nodes[n].items);
      EXPECT_EQ(used.work.nodes[n].inputs.size(), fresh.work.nodes[n].inputs.size());
    }
  }
}

}  // namespace
}  // namespace kernels
