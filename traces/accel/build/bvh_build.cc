#include "traces/accel/build/bvh_build.h"

#include <algorithm>
#include <cassert>
#include <limits>
#include <new>
#include <string>
#include <utility>

#include "sim/error.h"
#include "traces/accel/build/append_tree.h"
#include "traces/accel/build/binary_tree.h"
#include "traces/accel/build/lbvh.h"
#include "traces/accel/build/ploc.h"
#include "traces/accel/embree_api.h"
#include "traces/scene/bounds.h"

namespace traces {
namespace {

// Tree nodes that Embree's builder callbacks create in Embree's memory. They are small, because there may be one per
// triangle.

struct TreeNode {
  std::uint32_t count = 0;  ///< number of triangles of a leaf; 0 for an inner node
};

struct InnerNode : TreeNode {
  TreeNode* child[2] = {nullptr, nullptr};
  Bounds bounds[2];  ///< boxes of the two children
};

/// A leaf of the tree that Embree's builder makes. In memory `count` triangle indices follow the leaf.
struct LeafNode : TreeNode {
  std::uint32_t* triangle_indices() { return reinterpret_cast<std::uint32_t*>(this + 1); }
  const std::uint32_t* triangle_indices() const { return reinterpret_cast<const std::uint32_t*>(this + 1); }
};

Bounds bounds_of(const TriangleRecord& t) {
  Bounds b;
  for (const glm::vec3& v : {t.v0, t.v1, t.v2}) b.add(v);
  return b;
}

/// Allocates memory from Embree's builder. Throws std::bad_alloc, which ends the build, if Embree returns a null
/// pointer.
void* allocate_node(RTCThreadLocalAllocator allocator, std::size_t bytes) {
  void* memory = rtcThreadLocalAlloc(allocator, bytes, alignof(InnerNode));
  if (memory == nullptr) throw std::bad_alloc();
  return memory;
}

void* create_node(RTCThreadLocalAllocator allocator, unsigned, void*) {
  return new (allocate_node(allocator, sizeof(InnerNode))) InnerNode;
}

void set_children(void* node, void** children, unsigned count, void*) {
  assert(count == 2);
  std::copy_n(reinterpret_cast<TreeNode**>(children), count, static_cast<InnerNode*>(node)->child);
}

void set_bounds(void* node, const RTCBounds** bounds, unsigned count, void*) {
  for (unsigned i = 0; i < count; ++i) {
    const RTCBounds& b = *bounds[i];
    static_cast<InnerNode*>(node)->bounds[i] = {{b.lower_x, b.lower_y, b.lower_z}, {b.upper_x, b.upper_y, b.upper_z}};
  }
}

void* create_leaf(RTCThreadLocalAllocator allocator, const RTCBuildPrimitive* primitives, std::size_t count, void*) {
  assert(count >= 1 && count <= kMaxLeafTriangles);
  const std::size_t bytes = sizeof(LeafNode) + count * sizeof(std::uint32_t);
  auto* leaf = new (allocate_node(allocator, bytes)) LeafNode;
  leaf->count = static_cast<std::uint32_t>(count);
  std::transform(primitives, primitives + count, leaf->triangle_indices(),
                 [](const RTCBuildPrimitive& p) { return p.primID; });
  return leaf;
}

/// Embree's tree as append_subtree() reads it.
struct EmbreeTree {
  static bool is_leaf(const TreeNode* node) { return node->count != 0; }
  static const TreeNode* child(const TreeNode* node, int i) { return static_cast<const InnerNode*>(node)->child[i]; }
  static const Bounds& box(const TreeNode* node, int i) { return static_cast<const InnerNode*>(node)->bounds[i]; }
  static void append_items(const TreeNode* leaf, std::vector<std::uint32_t>& order) {
    const std::uint32_t* indices = static_cast<const LeafNode*>(leaf)->triangle_indices();
    order.insert(order.end(), indices, indices + leaf->count);
  }
};

/// Called by Embree during the build. Throws to end the build, because Embree 3 ignores the return value.
bool continue_build(void* stop, double) {
  if ((*static_cast<const sim::Stop*>(stop))()) throw sim::Cancelled{};
  return true;
}

/// Builds a tree over at least one box with Embree.
FlatBvh build_with_embree(RTCDevice device, std::span<const Bounds> boxes, const BvhConfig& config, sim::Stop stop) {
  Bounds all;
  std::vector<RTCBuildPrimitive> primitives(boxes.size());
  for (std::uint32_t i = 0; i < boxes.size(); ++i) {
    const Bounds& b = boxes[i];
    primitives[i] = {b.lower.x, b.lower.y, b.lower.z, 0, b.upper.x, b.upper.y, b.upper.z, i};
    all.add(b.lower);
    all.add(b.upper);
  }
  const EmbreeBvh bvh(rtcNewBVH(device));
  const std::size_t count = primitives.size();
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
  arguments.primitiveCount = arguments.primitiveArrayCapacity = count;
  arguments.createNode = create_node;
  arguments.setNodeChildren = set_children;
  arguments.setNodeBounds = set_bounds;
  arguments.createLeaf = create_leaf;
  if (stop != nullptr) {
    arguments.buildProgress = continue_build;
    arguments.userPtr = &stop;
  }
  const auto* root = static_cast<const TreeNode*>(rtcBuildBVH(&arguments));
  const RTCError error = rtcGetDeviceError(device);
  if (root == nullptr && stop != nullptr && stop()) throw sim::Cancelled{};
  if (error == RTC_ERROR_OUT_OF_MEMORY) throw std::bad_alloc();
  if (error != RTC_ERROR_NONE || root == nullptr) {  // Embree's error if the tree is too deep
    throw sim::InputError("bvh.max_depth: " + std::to_string(config.max_depth) + " levels are not enough for " +
                          std::to_string(count) + " triangles in leaves of " + std::to_string(config.leaf_size));
  }

  primitives = {};  // frees memory: the leaves have the indices
  return flat_tree(EmbreeTree{}, root, all, count);
}

}  // namespace

struct BvhBuilder::Device {
  EmbreeDevice embree;
};

BvhBuilder::BvhBuilder(const BvhConfig& config, unsigned threads, sim::Stop stop)
    : config_(config),
      stop_(stop),
      device_(config.builder == TreeBuilder::kEmbree ? new Device{open_embree("threads=" + std::to_string(threads))}
                                                     : nullptr) {}
BvhBuilder::~BvhBuilder() = default;

FlatBvh BvhBuilder::build_tree(std::span<const Bounds> boxes, const BvhConfig& config) const {
  if (boxes.empty()) return empty_tree();
  if (device_ != nullptr) return build_with_embree(device_->embree.get(), boxes, config, stop_);
  std::vector<std::uint32_t> clusters;
  BinaryTree tree = config.builder == TreeBuilder::kPloc ? build_ploc(boxes, config, stop_, clusters)
                                                         : build_lbvh(boxes, config, stop_);
  FlatBvh out = flatten_tree(tree, config);
  out.statistics.ploc_clusters = std::move(clusters);
  return out;
}

FlatBvh BvhBuilder::build_over(std::span<const TriangleRecord> triangles) const {
  std::vector<Bounds> boxes(triangles.size());
  std::ranges::transform(triangles, boxes.begin(), [](const TriangleRecord& t) { return bounds_of(t); });
  return build_tree(boxes, config_);
}

FlatBvh BvhBuilder::build_over(std::span<const Bounds> boxes) const {
  BvhConfig config = config_;
  config.leaf_size = 1;
  return build_tree(boxes, config);
}

}  // namespace traces
