#pragma once
#include <algorithm>
#include <cstdint>

#include "traces/accel/build/bvh_build.h"

namespace traces {

// Conversion of a builder's tree into a FlatBvh. A Source gives access to the tree: for a node `ref`, is_leaf(ref),
// child(ref, i) and box(ref, i) of its two children; for a leaf, append_items(ref, order).

inline float half_area(const Bounds& b) {
  const glm::vec3 d = b.upper - b.lower;
  return d.x * d.y + d.y * d.z + d.z * d.x;
}

/// Appends the tree below `ref` to `out` and returns the link word of its root. Items of a leaf are sorted.
template <class Source, class Ref>
std::uint32_t append_subtree(const Source& source, const Ref& ref, FlatBvh& out) {
  if (source.is_leaf(ref)) {
    const auto first = static_cast<std::uint32_t>(out.order.size());
    source.append_items(ref, out.order);
    std::sort(out.order.begin() + first, out.order.end());
    ++out.statistics.leaves;
    return leaf_link(first, static_cast<std::uint32_t>(out.order.size()) - first);
  }
  const auto index = static_cast<std::uint32_t>(out.nodes.size());
  out.nodes.emplace_back();
  const int larger = half_area(source.box(ref, 1)) > half_area(source.box(ref, 0)) ? 1 : 0;
  for (int i = 0; i < 2; ++i) {
    const int child = i ^ larger;
    const std::uint32_t link = append_subtree(source, source.child(ref, child), out);
    out.nodes[index].child[i] = link;
    set_box(out.nodes[index], i, source.box(ref, child));
  }
  return index;
}

inline NodeRecord childless_node() {
  NodeRecord node{};
  for (int i = 0; i < 2; ++i) {
    set_box(node, i, Bounds{});
    node.child[i] = kNoChild;
  }
  return node;
}

/// Converts a builder's tree with the given root and bounds. A single leaf gets an inner node as parent.
template <class Source, class Ref>
FlatBvh flat_tree(const Source& source, const Ref& root, const Bounds& bounds, std::size_t items) {
  FlatBvh out;
  out.nodes.reserve(items);
  out.order.reserve(items);
  if (source.is_leaf(root)) {
    NodeRecord node = childless_node();
    set_box(node, 0, bounds);
    node.child[0] = append_subtree(source, root, out);
    out.nodes.push_back(node);
  } else {
    append_subtree(source, root, out);
  }
  out.statistics.triangles = static_cast<std::uint32_t>(out.order.size());
  out.statistics.inner_nodes = static_cast<std::uint32_t>(out.nodes.size());
  return out;
}

/// Returns the tree without items: an inner node without children.
inline FlatBvh empty_tree() {
  FlatBvh out{{childless_node()}, {}, {}};
  out.statistics.inner_nodes = 1;
  return out;
}

}  // namespace traces
