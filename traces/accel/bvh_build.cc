#include "traces/accel/bvh_build.h"

#include <algorithm>
#include <cassert>
#include <limits>
#include <new>
#include <string>

#include "sim/error.h"
#include "traces/accel/embree_api.h"
#include "traces/scene/bounds.h"

namespace traces {
namespace {

/// What Embree's builder hands back through the callbacks; it lives in Embree's own memory.
struct TreeNode {
  TreeNode* child[2] = {nullptr, nullptr};
  Bounds bounds[2];         ///< of the children; of a leaf, bounds[0] is its own
  std::uint32_t count = 0;  ///< triangles of a leaf, 0 for an inner node
  std::uint32_t triangle[kMaxLeafTriangles] = {};
};

Bounds bounds_of(const TriangleRecord& t) {
  Bounds b;
  for (const glm::vec3& v : {t.v0, t.v1, t.v2}) b.add(v);
  return b;
}

float half_area(const Bounds& b) {
  const glm::vec3 d = b.upper - b.lower;
  return d.x * d.y + d.y * d.z + d.z * d.x;
}

void* create_node(RTCThreadLocalAllocator allocator, unsigned, void*) {
  return new (rtcThreadLocalAlloc(allocator, sizeof(TreeNode), 16)) TreeNode;
}

void set_children(void* node, void** children, unsigned count, void*) {
  assert(count == 2);
  std::copy_n(reinterpret_cast<TreeNode**>(children), count, static_cast<TreeNode*>(node)->child);
}

void set_bounds(void* node, const RTCBounds** bounds, unsigned count, void*) {
  for (unsigned i = 0; i < count; ++i) {
    const RTCBounds& b = *bounds[i];
    static_cast<TreeNode*>(node)->bounds[i] = {{b.lower_x, b.lower_y, b.lower_z}, {b.upper_x, b.upper_y, b.upper_z}};
  }
}

void* create_leaf(RTCThreadLocalAllocator allocator, const RTCBuildPrimitive* primitives, std::size_t count, void*) {
  assert(count <= kMaxLeafTriangles);
  auto* leaf = new (rtcThreadLocalAlloc(allocator, sizeof(TreeNode), 16)) TreeNode;
  leaf->count = static_cast<std::uint32_t>(count);
  for (std::size_t i = 0; i < count; ++i) {
    const RTCBuildPrimitive& p = primitives[i];
    leaf->triangle[i] = p.primID;
    leaf->bounds[0].add({p.lower_x, p.lower_y, p.lower_z});
    leaf->bounds[0].add({p.upper_x, p.upper_y, p.upper_z});
  }
  std::sort(leaf->triangle, leaf->triangle + count);
  return leaf;
}

void set_box(NodeRecord& node, int child, const Bounds& b) {
  for (auto [lanes, axis] : {std::pair{node.x, 0}, {node.y, 1}, {node.z, 2}}) {
    lanes[child] = b.lower[axis];
    lanes[2 + child] = b.upper[axis];
  }
}

/// Copies the tree below `node` behind what is already placed; returns its link word.
std::uint32_t place(const TreeNode& node, PlacedBvh& out) {
  if (node.count != 0) {
    const auto first = static_cast<std::uint32_t>(out.order.size());
    out.order.insert(out.order.end(), node.triangle, node.triangle + node.count);
    return leaf_link(first, node.count);
  }
  const auto index = static_cast<std::uint32_t>(out.nodes.size());
  out.nodes.emplace_back();
  const int larger = half_area(node.bounds[1]) > half_area(node.bounds[0]) ? 1 : 0;
  for (int i = 0; i < 2; ++i) {
    const int child = i ^ larger;
    const std::uint32_t link = place(*node.child[child], out);
    out.nodes[index].child[i] = link;
    set_box(out.nodes[index], i, node.bounds[child]);
  }
  return index;
}

/// The root is always an inner node: a lone leaf, or nothing at all, is put below one.
void place_root(const TreeNode* root, PlacedBvh& out) {
  if (root != nullptr && root->count == 0) {
    place(*root, out);
    return;
  }
  NodeRecord& node = out.nodes.emplace_back();
  for (int i = 0; i < 2; ++i) {
    set_box(node, i, Bounds{});
    node.child[i] = kNoChild;
  }
  if (root != nullptr) {
    set_box(node, 0, root->bounds[0]);
    node.child[0] = place(*root, out);
  }
}

std::vector<RTCBuildPrimitive> primitives_of(std::span<const TriangleRecord> triangles) {
  std::vector<RTCBuildPrimitive> primitives(triangles.size());
  for (std::uint32_t i = 0; i < triangles.size(); ++i) {
    const Bounds b = bounds_of(triangles[i]);
    primitives[i] = {b.lower.x, b.lower.y, b.lower.z, 0, b.upper.x, b.upper.y, b.upper.z, i};
  }
  return primitives;
}

}  // namespace

PlacedBvh build_bvh(std::span<const TriangleRecord> triangles, const BvhConfig& config, unsigned threads) {
  PlacedBvh out;
  if (triangles.empty()) {
    place_root(nullptr, out);
    return out;
  }
  const EmbreeDevice device = open_embree("threads=" + std::to_string(threads));
  const EmbreeBvh bvh(rtcNewBVH(device.get()));
  std::vector<RTCBuildPrimitive> primitives = primitives_of(triangles);

  RTCBuildArguments arguments = rtcDefaultBuildArguments();
  arguments.buildQuality = RTC_BUILD_QUALITY_MEDIUM;
  arguments.maxBranchingFactor = 2;
  arguments.maxDepth = config.max_depth;
  arguments.minLeafSize = 1;
  arguments.maxLeafSize = config.leaf_size;
  arguments.traversalCost = static_cast<float>(config.traversal_cost);
  arguments.intersectionCost = static_cast<float>(config.intersection_cost);
  arguments.bvh = bvh.get();
  arguments.primitives = primitives.data();
  arguments.primitiveCount = arguments.primitiveArrayCapacity = primitives.size();
  arguments.createNode = create_node;
  arguments.setNodeChildren = set_children;
  arguments.setNodeBounds = set_bounds;
  arguments.createLeaf = create_leaf;
  const auto* root = static_cast<const TreeNode*>(rtcBuildBVH(&arguments));
  const RTCError error = rtcGetDeviceError(device.get());
  if (error == RTC_ERROR_OUT_OF_MEMORY) throw std::bad_alloc();
  if (error != RTC_ERROR_NONE || root == nullptr) {  // what Embree says when the depth does not suffice
    throw sim::InputError("bvh.max_depth: " + std::to_string(config.max_depth) + " levels are not enough for " +
                          std::to_string(triangles.size()) + " triangles in leaves of " +
                          std::to_string(config.leaf_size));
  }

  out.nodes.reserve(primitives.size());
  out.order.reserve(primitives.size());
  place_root(root, out);
  return out;
}

}  // namespace traces
