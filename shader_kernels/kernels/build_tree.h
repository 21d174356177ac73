#pragma once
#include <string_view>

#include "shader_kernels/ports.h"
#include "shader_kernels/value.h"
#include "sim/named.h"

namespace kernels {

// Kernels that build a binary tree by sorting Morton codes (build.engine: srp). One launch of each kernel covers one
// batch of triangles, records or nodes, which transfers move between memory and the tile buffer.

/// Corners of a triangle, as vertex numbers select them from the scene's vertices.
template <class V>
struct CornersRecord {
  Vec3<V> v0, v1, v2;
  static void fields(auto& r, auto&& field) { name_all(field, NAMED_ALL(r.v0, r.v1, r.v2)); }
};

/// A triangle while its tree is built: box, corners and number, 68 bytes with a word for its material.
template <class V>
struct BuildLeafRecord {
  Vec3<V> lower, upper, v0, v1, v2;
  I<V> number, material;
  static void fields(auto& r, auto&& field) {
    name_all(field, NAMED_ALL(r.lower, r.upper, r.v0, r.v1, r.v2, r.number, r.material));
  }
};

/// A Morton code and the number of its triangle.
template <class V>
struct KeyRecord {
  I<V> key, number;
  static void fields(auto& r, auto&& field) { name_all(field, NAMED_ALL(r.key, r.number)); }
};

/// A count of keys, or the place of the next key.
template <class V>
struct CountRecord {
  I<V> number;
  static void fields(auto& r, auto&& field) { name_all(field, NAMED_ALL(r.number)); }
};

/// Range of sorted triangles below a node of the tree.
template <class V>
struct RangeRecord {
  I<V> first, last;
  static void fields(auto& r, auto&& field) { name_all(field, NAMED_ALL(r.first, r.last)); }
};

template <class V>
struct BoxRecord {
  Vec3<V> lower, upper;
  static void fields(auto& r, auto&& field) { name_all(field, NAMED_ALL(r.lower, r.upper)); }
};

/// Inner node while its tree is built: box and indices of the children's boxes, 40 bytes with two spare words.
template <class V>
struct BuildNodeRecord {
  Vec3<V> lower, upper;
  I<V> left, right, left_link, right_link;
  static void fields(auto& r, auto&& field) {
    name_all(field, NAMED_ALL(r.lower, r.upper, r.left, r.right, r.left_link, r.right_link));
  }
};

/// Inner node as traces::NodeRecord: for each axis, the lower planes of both children, then the upper planes.
template <class V>
struct NodeFields {
  F<V> x0, x1, x2, x3, y0, y1, y2, y3, z0, z1, z2, z3;
  I<V> left_link, right_link, spare0, spare1;
  static void fields(auto& r, auto&& field) {
    name_all(field, NAMED_ALL(r.x0, r.x1, r.x2, r.x3, r.y0, r.y1, r.y2, r.y3, r.z0, r.z1, r.z2, r.z3, r.left_link,
                              r.right_link, r.spare0, r.spare1));
  }
};

/// Leaf record, as traces::TriangleRecord.
template <class V>
struct LeafFields {
  Vec3<V> v0, v1, v2;
  I<V> object, material, source;
  static void fields(auto& r, auto&& field) {
    name_all(field, NAMED_ALL(r.v0, r.v1, r.v2, r.object, r.material, r.source));
  }
};

template <class V>
Vec3<V> min_of(const Vec3<V>& a, const Vec3<V>& b) {
  return {min(a.x, b.x), min(a.y, b.y), min(a.z, b.z)};
}
template <class V>
Vec3<V> max_of(const Vec3<V>& a, const Vec3<V>& b) {
  return {max(a.x, b.x), max(a.y, b.y), max(a.z, b.z)};
}

/// Moves the low eight bits of a word to every third bit.
template <class V>
I<V> spread_bits(const I<V>& x) {
  I<V> bits = (x | (x << 8U)) & 0x00f00fU;
  bits = (bits | (bits << 4U)) & 0x0c30c3U;
  return (bits | (bits << 2U)) & 0x249249U;
}

/// Computes a triangle's box, and its Morton code of eight bits per axis, which is that of the box's centre.
struct BuildLeaf {
  static constexpr std::string_view kName = "build_leaf";
  static constexpr std::string_view kMeaning = "triangle -> its box and Morton code";
  template <class V>
  struct Ports {
    Local<V, CornersRecord> corners;
    Local<V, KeyRecord> inputs;  ///< material and number of each triangle
    Local<V, BuildLeafRecord> leaves;
    Local<V, KeyRecord> keys;
    Vec3<V> scene_lower;  ///< sum of the scene's lower bounds with itself
    Vec3<V> grid_scale;   ///< half the grid cells per unit length: scales lower + upper plane
    static constexpr void describe(auto& p, auto&& port) {
      name_all(port, NAMED_ALL(p.corners, p.inputs, p.leaves, p.keys, p.scene_lower, p.grid_scale));
    }
  };
  template <class V>
  static void body(const I<V>& item, Ports<V>& io) {
    const CornersRecord<V> t = io.corners.load(item);
    const KeyRecord<V> input = io.inputs.load(item);
    const Vec3<V> lower = min_of<V>(min_of<V>(t.v0, t.v1), t.v2), upper = max_of<V>(max_of<V>(t.v0, t.v1), t.v2);
    const Vec3<V> cell = (lower + upper - io.scene_lower) * io.grid_scale;
    const auto code = [](const F<V>& x) { return spread_bits<V>(to_int(min(max(x, F<V>(0.0F)), F<V>(255.0F)))); };
    const I<V> y = code(cell.y) << 1U, z = code(cell.z) << 2U;
    io.leaves.store(item, {lower, upper, t.v0, t.v1, t.v2, input.number, input.key});
    io.keys.store(item, {code(cell.x) | y | z, input.number});
  }
};

/// Returns the digit of a key by which a pass sorts: eight bits from bit `shift`.
template <class V>
I<V> digit_of(const I<V>& key, const I<V>& shift) {
  return (key >> shift) & 255U;
}

/// Counts the keys of a batch by digit.
struct SortHistogram {
  static constexpr std::string_view kName = "sort_histogram";
  static constexpr std::string_view kMeaning = "key -> one more key with its digit";
  template <class V>
  struct Ports {
    Local<V, KeyRecord> keys;
    Local<V, CountRecord> counts;
    I<V> digit_shift;
    static constexpr void describe(auto& p, auto&& port) { name_all(port, NAMED_ALL(p.keys, p.counts, p.digit_shift)); }
  };
  template <class V>
  static void body(const I<V>& item, Ports<V>& io) {
    const I<V> digit = digit_of<V>(io.keys.load(item).key, io.digit_shift);
    io.counts.store(digit, {io.counts.load(digit).number + 1U});
  }
};

/// Turns counts into places: the place of a count is the sum of all counts before it.
struct SortScan {
  static constexpr std::string_view kName = "sort_scan";
  static constexpr std::string_view kMeaning = "count of keys -> place of the first of them";
  template <class V>
  struct Ports {
    Local<V, CountRecord> counts, places;
    LoopCarried<V> sum;
    static constexpr void describe(auto& p, auto&& port) { name_all(port, NAMED_ALL(p.counts, p.places, p.sum)); }
  };
  template <class V>
  static void body(const I<V>& item, Ports<V>& io) {
    const F<V> before = io.sum.get();
    io.sum.set(before + to_float(io.counts.load(item).number));
    io.places.store(item, {to_int(before)});
  }
};

/// Moves each key of a batch to the next place of its digit.
struct SortScatter {
  static constexpr std::string_view kName = "sort_scatter";
  static constexpr std::string_view kMeaning = "key -> its place by this digit";
  template <class V>
  struct Ports {
    Local<V, KeyRecord> keys;
    Local<V, CountRecord> places;
    Local<V, KeyRecord> sorted;
    I<V> digit_shift;
    static constexpr void describe(auto& p, auto&& port) {
      name_all(port, NAMED_ALL(p.keys, p.places, p.sorted, p.digit_shift));
    }
  };
  template <class V>
  static void body(const I<V>& item, Ports<V>& io) {
    const KeyRecord<V> key = io.keys.load(item);
    const I<V> digit = digit_of<V>(key.key, io.digit_shift);
    const I<V> place = io.places.load(digit).number;
    io.places.store(digit, {place + 1U});
    io.sorted.store(place, key);
  }
};

/// Finds the parent of a node, given its range of sorted triangles: the split at the neighbour whose code differs in
/// less. Method: Apetrei, "Fast and Simple Agglomerative LBVH Construction", 2014.
struct LinkNode {
  static constexpr std::string_view kName = "link_node";
  static constexpr std::string_view kMeaning = "node's range of triangles -> its parent in the hierarchy";
  template <class V>
  struct Ports {
    Local<V, RangeRecord> ranges;
    Local<V, KeyRecord> sorted;
    Local<V, CountRecord> parents;
    I<V> last_triangle;
    static constexpr void describe(auto& p, auto&& port) {
      name_all(port, NAMED_ALL(p.ranges, p.sorted, p.parents, p.last_triangle));
    }
  };
  template <class V>
  static void body(const I<V>& item, Ports<V>& io) {
    const RangeRecord<V> range = io.ranges.load(item);
    const M<V> begins = range.first == 0U, ends = range.last == io.last_triangle;
    const I<V> before = select(begins, range.first, range.first - 1U);
    const I<V> after = select(ends, range.last, range.last + 1U);
    const KeyRecord<V> left = io.sorted.load(before), first = io.sorted.load(range.first);
    const KeyRecord<V> last = io.sorted.load(range.last), right = io.sorted.load(after);
    const I<V> below = left.key ^ first.key, above = last.key ^ right.key;
    const I<V> parent = select(above < below, range.last, before);
    io.parents.store(item, {select(begins, range.last, select(ends, before, parent))});
  }
};

/// Computes the box of a node from the boxes of its children.
struct FitNode {
  static constexpr std::string_view kName = "fit_node";
  static constexpr std::string_view kMeaning = "node's children -> its box";
  template <class V>
  struct Ports {
    Local<V, BuildNodeRecord> nodes;
    Local<V, BoxRecord> boxes;
    Local<V, BoxRecord> fitted;
    static constexpr void describe(auto& p, auto&& port) { name_all(port, NAMED_ALL(p.nodes, p.boxes, p.fitted)); }
  };
  template <class V>
  static void body(const I<V>& item, Ports<V>& io) {
    const BuildNodeRecord<V> node = io.nodes.load(item);
    const BoxRecord<V> left = io.boxes.load(node.left);
    const BoxRecord<V> right = io.boxes.load(node.right);
    io.fitted.store(item, {min_of<V>(left.lower, right.lower), max_of<V>(left.upper, right.upper)});
  }
};

/// Writes an inner node in the format of traversal units.
struct EncodeNode {
  static constexpr std::string_view kName = "encode_node";
  static constexpr std::string_view kMeaning = "node's children -> its record for traversal";
  template <class V>
  struct Ports {
    Local<V, BuildNodeRecord> nodes;
    Local<V, BoxRecord> boxes;
    Local<V, NodeFields> encoded;
    static constexpr void describe(auto& p, auto&& port) { name_all(port, NAMED_ALL(p.nodes, p.boxes, p.encoded)); }
  };
  template <class V>
  static void body(const I<V>& item, Ports<V>& io) {
    const BuildNodeRecord<V> n = io.nodes.load(item);
    const BoxRecord<V> a = io.boxes.load(n.left);
    const BoxRecord<V> b = io.boxes.load(n.right);
    io.encoded.store(item, {a.lower.x, b.lower.x, a.upper.x, b.upper.x, a.lower.y, b.lower.y, a.upper.y, b.upper.y,
                            a.lower.z, b.lower.z, a.upper.z, b.upper.z, n.left_link, n.right_link, 0U, 0U});
  }
};

/// Writes a leaf record in the format of intersection units.
struct EncodeLeaf {
  static constexpr std::string_view kName = "encode_leaf";
  static constexpr std::string_view kMeaning = "triangle in leaf order -> its leaf record";
  template <class V>
  struct Ports {
    Local<V, KeyRecord> sorted;
    Local<V, BuildLeafRecord> leaves;
    Local<V, CountRecord> objects;
    Local<V, LeafFields> encoded_leaves;
    static constexpr void describe(auto& p, auto&& port) {
      name_all(port, NAMED_ALL(p.sorted, p.leaves, p.objects, p.encoded_leaves));
    }
  };
  template <class V>
  static void body(const I<V>& item, Ports<V>& io) {
    const I<V> number = io.sorted.load(item).number;
    const BuildLeafRecord<V> t = io.leaves.load(number);
    const I<V> object = io.objects.load(number).number;
    io.encoded_leaves.store(item, {t.v0, t.v1, t.v2, object, t.material, t.number});
  }
};

}  // namespace kernels
