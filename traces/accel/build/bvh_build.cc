#include "traces/accel/build/bvh_build.h"

#include <algorithm>
#include <cassert>
#include <limits>
#include <new>
#include <string>
#include <utility>

#include "sim/error.h"
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

float half_area(const Bounds& b) {
  const glm::vec3 d = b.upper - b.lower;
  return d.x * d.y + d.y * d.z + d.z * d.x;
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
  std::sort(leaf->triangle_indices(), leaf->triangle_indices() + count);
  return leaf;
}

/// Appends Embree's tree below `root` to `out` and returns the link word of its root.
std::uint32_t append_subtree(const TreeNode& root, FlatBvh& out) {
  if (root.count != 0) {
    const std::uint32_t* triangles = static_cast<const LeafNode&>(root).triangle_indices();
    const auto first = static_cast<std::uint32_t>(out.order.size());
    out.order.insert(out.order.end(), triangles, triangles + root.count);
    return leaf_link(first, root.count);
  }
  const auto& node = static_cast<const InnerNode&>(root);
  const auto index = static_cast<std::uint32_t>(out.nodes.size());
  out.nodes.emplace_back();
  const int larger = half_area(node.bounds[1]) > half_area(node.bounds[0]) ? 1 : 0;
  for (int i = 0; i < 2; ++i) {
    const int child = i ^ larger;
    const std::uint32_t link = append_subtree(*node.child[child], out);
    out.nodes[index].child[i] = link;
    set_box(out.nodes[index], i, node.bounds[child]);
  }
  return index;
}

/// Appends the root of Embree's tree to `out` as an inner node. A single leaf or an empty tree gets an inner node as
/// parent. `bounds` are those of the whole tree.
void append_root(const TreeNode* root, const Bounds& bounds, FlatBvh& out) {
  if (root != nullptr && root->count == 0) {
    append_subtree(*root, out);
    return;
  }
  NodeRecord& node = out.nodes.emplace_back();
  for (int i = 0; i < 2; ++i) {
    set_box(node, i, Bounds{});
    node.child[i] = kNoChild;
  }
  if (root != nullptr) {
    set_box(node, 0, bounds);
    node.child[0] = append_subtree(*root, out);
  }
}

/// Called by Embree during the build. Throws to end the build, because Embree 3 ignores the return value.
bool continue_build(void* stop, double) {
  if ((*static_cast<const sim::Stop*>(stop))()) throw sim::Cancelled{};
  return true;
}

Bounds bounds_of(const Bounds& box) { return box; }

template <class Item>
std::vector<RTCBuildPrimitive> primitives_of(std::span<const Item> items, Bounds& all) {
  std::vector<RTCBuildPrimitive> primitives(items.size());
  for (std::uint32_t i = 0; i < items.size(); ++i) {
    const Bounds b = bounds_of(items[i]);
    primitives[i] = {b.lower.x, b.lower.y, b.lower.z, 0, b.upper.x, b.upper.y, b.upper.z, i};
    all.add(b.lower);
    all.add(b.upper);
  }
  return primitives;
}

FlatBvh build_tree(RTCDevice device, std::vector<RTCBuildPrimitive> primitives, const Bounds& all,
                   const BvhConfig& config, sim::Stop stop) {
  FlatBvh out;
  if (primitives.empty()) {
    append_root(nullptr, {}, out);
    return out;
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
  out.nodes.reserve(count);
  out.order.reserve(count);
  append_root(root, all, out);
  return out;
}

}  // namespace

struct BvhBuilder::Device {
  EmbreeDevice embree;
};

BvhBuilder::BvhBuilder(const BvhConfig& config, unsigned threads, sim::Stop stop)
    : config_(config), stop_(stop), device_(new Device{open_embree("threads=" + std::to_string(threads))}) {}
BvhBuilder::~BvhBuilder() = default;

FlatBvh BvhBuilder::build_over(std::span<const TriangleRecord> triangles) const {
  Bounds all;
  std::vector<RTCBuildPrimitive> primitives = primitives_of(triangles, all);
  return build_tree(device_->embree.get(), std::move(primitives), all, config_, stop_);
}

FlatBvh BvhBuilder::build_over(std::span<const Bounds> boxes) const {
  Bounds all;
  std::vector<RTCBuildPrimitive> primitives = primitives_of(boxes, all);
  BvhConfig config = config_;
  config.leaf_size = 1;
  return build_tree(device_->embree.get(), std::move(primitives), all, config, stop_);
}

}  // namespace traces
