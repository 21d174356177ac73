#pragma once
#include <array>
#include <cstddef>
#include <string_view>

#include "shader_kernels/kernels/build_tree.h"
#include "shader_kernels/ports.h"
#include "shader_kernels/value.h"
#include "sim/named.h"

namespace kernels {

// Kernels that make wide nodes of a binary hierarchy.

/// The children of a wide node while it is collapsed, in slots: index and area of each child's box. Leaves have no
/// area, so they are not opened.
template <class V>
struct WideChildren {
  I<V> child0, child1, child2, child3, child4, child5, child6, child7;
  F<V> area0, area1, area2, area3, area4, area5, area6, area7;
  I<V> count;
  static void fields(auto& r, auto&& field) {
    name_all(field, NAMED_ALL(r.child0, r.child1, r.child2, r.child3, r.child4, r.child5, r.child6, r.child7, r.area0,
                              r.area1, r.area2, r.area3, r.area4, r.area5, r.area6, r.area7, r.count));
  }
};

/// Returns half the surface of a box, or 0 for a leaf.
template <class V>
F<V> inner_area(const BoxRecord<V>& box, const I<V>& link) {
  const Vec3<V> d = box.upper - box.lower;
  return select(link >> 31U == 0U, d.x * d.y + d.y * d.z + d.z * d.x, F<V>(0.0F));
}

/// Replaces the largest inner child of a wide node by its two children: greedy collapse by area, as in drivers. A wide
/// node of c children takes c - 1 items.
struct CollapseNode {
  static constexpr std::string_view kName = "collapse_node";
  static constexpr std::string_view kMeaning = "largest inner child of a wide node -> its two children";
  template <class V>
  struct Ports {
    Local<V, CountRecord> wide_numbers;  ///< wide node of each item
    Local<V, WideChildren> wide_children;
    Local<V, BuildNodeRecord> nodes;
    Local<V, BoxRecord> boxes;
    static constexpr void describe(auto& p, auto&& port) {
      name_all(port, NAMED_ALL(p.wide_numbers, p.wide_children, p.nodes, p.boxes));
    }
  };
  template <class V>
  static void body(const I<V>& item, Ports<V>& io) {
    const I<V> wide = io.wide_numbers.load(item).number;
    const WideChildren<V> w = io.wide_children.load(wide);
    std::array<I<V>, 8> child{w.child0, w.child1, w.child2, w.child3, w.child4, w.child5, w.child6, w.child7};
    std::array<F<V>, 8> area{w.area0, w.area1, w.area2, w.area3, w.area4, w.area5, w.area6, w.area7};
    F<V> largest = area[0];
    I<V> slot(0U), opened = child[0];
    for (std::uint32_t k = 1; k < 8; ++k) {
      const M<V> is_larger = largest < area[k];
      largest = select(is_larger, area[k], largest);
      slot = select(is_larger, I<V>(k), slot);
      opened = select(is_larger, child[k], opened);
    }
    const BuildNodeRecord<V> node = io.nodes.load(opened);
    const BoxRecord<V> left = io.boxes.load(node.left);
    const BoxRecord<V> right = io.boxes.load(node.right);
    const F<V> left_area = inner_area<V>(left, node.left_link), right_area = inner_area<V>(right, node.right_link);
    for (std::uint32_t k = 0; k < 8; ++k) {
      const M<V> is_opened = slot == I<V>(k), is_next = w.count == I<V>(k);
      child[k] = select(is_opened, node.left, select(is_next, node.right, child[k]));
      area[k] = select(is_opened, left_area, select(is_next, right_area, area[k]));
    }
    io.wide_children.store(
        wide, {child[0], child[1], child[2], child[3], child[4], child[5], child[6], child[7], area[0], area[1],
               area[2], area[3], area[4], area[5], area[6], area[7], w.count + 1U});
  }
};

/// A child of a wide float node: box and link.
template <class V>
struct ChildRecord {
  Vec3<V> lower, upper;
  I<V> link;
  static void fields(auto& r, auto&& field) { name_all(field, NAMED_ALL(r.lower, r.upper, r.link)); }
};

/// Writes the box and link of one child of a wide node of floats.
struct EncodeChild {
  static constexpr std::string_view kName = "encode_child";
  static constexpr std::string_view kMeaning = "child of a wide node -> its planes and link";
  template <class V>
  struct Ports {
    Local<V, BoxRecord> boxes;
    Local<V, CountRecord> links;
    Local<V, ChildRecord> encoded_children;
    static constexpr void describe(auto& p, auto&& port) {
      name_all(port, NAMED_ALL(p.boxes, p.links, p.encoded_children));
    }
  };
  template <class V>
  static void body(const I<V>& item, Ports<V>& io) {
    const BoxRecord<V> box = io.boxes.load(item);
    const CountRecord<V> link = io.links.load(item);
    io.encoded_children.store(item, {box.lower, box.upper, link.number});
  }
};

/// The planes of a wide node on its own grid: position = origin + number / scale, numbers 0 to `last`.
template <class V>
struct NodeGrid {
  Vec3<V> origin, scale;
  F<V> last;
  static void fields(auto& r, auto&& field) { name_all(field, NAMED_ALL(r.origin, r.scale, r.last)); }
};

/// Quantised planes of a child: for each axis the lower plane in the low half of a word, the upper in the high half.
template <class V>
struct QuantisedChild {
  I<V> x, y, z;
  static void fields(auto& r, auto&& field) { name_all(field, NAMED_ALL(r.x, r.y, r.z)); }
};

/// Quantises the box of one child of a wide node, outward.
struct QuantiseChild {
  static constexpr std::string_view kName = "quantise_child";
  static constexpr std::string_view kMeaning = "child of a wide node -> its quantised planes";
  template <class V>
  struct Ports {
    Local<V, BoxRecord> boxes;
    Local<V, CountRecord> wide_numbers;  ///< wide node of each child
    Local<V, NodeGrid> node_grids;
    Local<V, QuantisedChild> quantised;
    static constexpr void describe(auto& p, auto&& port) {
      name_all(port, NAMED_ALL(p.boxes, p.wide_numbers, p.node_grids, p.quantised));
    }
  };
  template <class V>
  static void body(const I<V>& item, Ports<V>& io) {
    const BoxRecord<V> box = io.boxes.load(item);
    const CountRecord<V> wide = io.wide_numbers.load(item);
    const NodeGrid<V> grid = io.node_grids.load(wide.number);
    const Vec3<V> lower = (box.lower - grid.origin) * grid.scale, upper = (box.upper - grid.origin) * grid.scale;
    const auto clamped = [&](const F<V>& x) { return to_int(min(max(x, F<V>(0.0F)), grid.last)); };
    const auto planes = [&](const F<V>& low, const F<V>& high) {
      return clamped(floor(low)) | (clamped(-floor(-high)) << 16U);
    };
    io.quantised.store(item, {planes(lower.x, upper.x), planes(lower.y, upper.y), planes(lower.z, upper.z)});
  }
};

}  // namespace kernels
