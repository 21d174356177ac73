#include "traces/accel/tree_builds.h"

#include <algorithm>
#include <bit>
#include <cstddef>
#include <unordered_map>
#include <utility>

#include "sim/error.h"
#include "sim/hash.h"

namespace traces {
namespace {

/// A vertex position as bits.
struct PositionBits {
  std::array<std::uint32_t, 3> bits{};
  explicit PositionBits(const glm::vec3& v)
      : bits{std::bit_cast<std::uint32_t>(v.x), std::bit_cast<std::uint32_t>(v.y), std::bit_cast<std::uint32_t>(v.z)} {}
  friend bool operator==(const PositionBits&, const PositionBits&) = default;
};
struct HashPosition {
  std::size_t operator()(const PositionBits& p) const { return sim::hash(p.bits[0], p.bits[1], p.bits[2]); }
};

/// Triangles and nodes of one tree: from first to end - 1.
struct TreeExtent {
  std::uint32_t first_triangle = 0, end_triangle = 0;
  std::uint32_t first_node = 0, end_node = 0;
};

/// Returns the ranges that a tree over triangles occupies in memory: nodes, leaf records and labels. If nodes and leaf
/// records are in one array, the first range has both.
std::array<BuildWork::Range, 3> output_of(const MemoryImage& image, const TreeExtent& tree) {
  const Layout& layout = image.layout;
  const bool one_array = layout.triangles == layout.nodes;
  const std::uint64_t instance_bytes = one_array ? 0 : image.instances.size() * sizeof(InstanceRecord);
  const std::uint64_t node_bytes = layout.tree_bytes - instance_bytes - (one_array ? 0 : layout.leaf_bytes);
  const auto node = [&](std::uint32_t i) {
    if (i == 0) return std::uint64_t{0};
    return i == image.node_count() ? node_bytes : layout.node_at(i) - layout.nodes;
  };
  const auto range = [](std::uint64_t begin, std::uint64_t end) { return BuildWork::Range{begin, end - begin}; };
  std::array<BuildWork::Range, 3> out{range(node(tree.first_node), node(tree.end_node))};
  if (one_array) return out;
  const auto triangle = [&](std::uint32_t i) {
    const bool is_end = i == image.triangles.size();
    return (is_end ? layout.triangles + layout.leaf_bytes : layout.triangle_at(i)) - layout.nodes;
  };
  out[1] = range(triangle(tree.first_triangle), triangle(tree.end_triangle));
  if (layout.has_labels()) {
    out[2] =
        range(layout.label_at(tree.first_triangle) - layout.nodes, layout.label_at(tree.end_triangle) - layout.nodes);
  }
  return out;
}

/// Returns the comparisons of clusters in the build of a tree, the `tree`th of MemoryImage::build_statistics.
std::uint64_t comparisons_of(const MemoryImage& image, std::size_t tree, std::uint32_t ploc_radius) {
  std::uint64_t clusters = 0;
  for (const std::uint32_t round : image.build_statistics.at(tree).ploc_clusters) clusters += round;
  return clusters * ploc_radius;
}

/// Adds the tree over triangles with the given extent.
void add_triangle_tree(const MemoryImage& image, const TreeExtent& tree, bool refit, TreeBuilds& builds) {
  TreeBuild& build = builds.trees.emplace_back();
  build.items = tree.end_triangle - tree.first_triangle;
  build.job = {.refit = refit, .first_item = builds.sizes.triangles, .output = output_of(image, tree)};
  build.order.resize(build.items);
  std::vector<std::uint32_t> at(build.items);  // for each triangle in input order, its index in the image
  for (std::uint32_t i = 0; i < build.items; ++i) {
    build.order[i] = image.triangles[tree.first_triangle + i].source;
    at[build.order[i]] = tree.first_triangle + i;
  }
  std::unordered_map<PositionBits, std::uint32_t, HashPosition> numbers;
  build.triangles.reserve(build.items);
  for (const std::uint32_t i : at) {
    const TriangleRecord& t = image.triangles[i];
    std::array<std::uint32_t, 3>& vertices = build.triangles.emplace_back();
    for (std::size_t corner = 0; const glm::vec3& v : {t.v0, t.v1, t.v2}) {
      const auto next = builds.sizes.vertices + static_cast<std::uint32_t>(numbers.size());
      vertices[corner++] = numbers.emplace(PositionBits(v), next).first->second;
    }
  }
  builds.sizes.vertices += static_cast<std::uint32_t>(numbers.size());
  builds.sizes.triangles += build.items;
}

}  // namespace

TreeBuilds tree_builds(const MemoryImage& image, bool refit, bool overlap, std::uint32_t ploc_radius) {
  TreeBuilds builds;
  const auto nodes = static_cast<std::uint32_t>(image.node_count());
  const auto triangles = static_cast<std::uint32_t>(image.triangles.size());
  if (!image.has_two_levels()) {
    if (triangles != 0) {
      add_triangle_tree(image, {0, triangles, 0, nodes}, refit, builds);
      if (!refit) builds.trees.back().job.comparisons = comparisons_of(image, 0, ploc_radius);
    }
  } else {
    if (!image.layout.single_boxes.empty()) {
      throw sim::InputError(
          "build.engine: does not build trees of single boxes in two levels; allowed: bvh.boxes=pair");
    }
    TreeBuild& top = builds.trees.emplace_back();
    top.items = static_cast<std::uint32_t>(image.instances.size());
    const std::uint32_t end = image.trees.empty() ? nodes : image.trees.front().first_node;
    top.job = {.input = BuildWork::Input::kInstances, .output = output_of(image, {0, 0, 0, end})};
    if (image.layout.triangles != image.layout.nodes) {
      top.job.output[1] = {image.layout.instances - image.layout.nodes, top.items * sizeof(InstanceRecord)};
    }
    top.job.output[2] = {};
    top.job.comparisons = comparisons_of(image, 0, ploc_radius);
    builds.sizes.instances = top.items;
    for (std::size_t i = 0; i < image.trees.size(); ++i) {
      const ObjectTree& tree = image.trees[i];
      if (tree.only == kNone || tree.triangles == 0) continue;
      const std::uint32_t end_node = i + 1 < image.trees.size() ? image.trees[i + 1].first_node : nodes;
      add_triangle_tree(image, {tree.first_triangle, tree.first_triangle + tree.triangles, tree.first_node, end_node},
                        refit, builds);
      if (!refit) builds.trees.back().job.comparisons = comparisons_of(image, i + 1, ploc_radius);
    }
  }
  if (overlap) {
    for (const TreeBuild& build : builds.trees) {
      for (const BuildWork::Range& range : build.job.output) {
        builds.sizes.shadow_bytes = std::max(builds.sizes.shadow_bytes, range.offset + range.bytes);
      }
    }
  }
  return builds;
}

void set_build_arrays(const TreeBuild& build, TileWork& work) {
  work.build = {build.job};
  work.build_triangles = build.triangles;
  work.build_order = build.order;
}

}  // namespace traces
