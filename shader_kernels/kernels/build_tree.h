#pragma once
#include <string_view>

#include "shader_kernels/ports.h"
#include "shader_kernels/value.h"
#include "sim/named.h"

namespace kernels {

// Kernels that build and refit a binary tree by sorting Morton codes (build.engine: srp). One launch of each kernel
// covers one batch of triangles, records or nodes, which transfers move between memory and the tile buffer.

/// Corners of a triangle, as vertex numbers select them from the scene's vertices.
template <class V>
struct CornersRecord {
  Vec3<V> v0, v1, v2;
  static void fields(auto& r, auto&& field) { name_all(field, NAMED_ALL(r.v0, r.v1, r.v2)); }
};

/// A triangle while its tree is built: corners, number, material and object, 48 bytes. Its box is in another array.
template <class V>
struct BuildLeafRecord {
  Vec3<V> v0, v1, v2;
  I<V> number, material, object;
  static void fields(auto& r, auto&& field) {
    name_all(field, NAMED_ALL(r.v0, r.v1, r.v2, r.number, r.material, r.object));
  }
};

/// The cubic grid of Morton codes: its lower corner, doubled, and half its cells per unit length, 16 bytes. The grid
/// applies to the sum of a box's planes, which is twice the centre.
template <class V>
struct GridRecord {
  Vec3<V> lower;
  F<V> scale;
  static void fields(auto& r, auto&& field) { name_all(field, NAMED_ALL(r.lower, r.scale)); }
};

/// What a hit needs of a triangle besides its corners: material and object.
template <class V>
struct LabelRecord {
  I<V> material, object;
  static void fields(auto& r, auto&& field) { name_all(field, NAMED_ALL(r.material, r.object)); }
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

/// Moves the low ten bits of a word to every third bit.
template <class V>
I<V> spread_bits(const I<V>& x) {
  I<V> bits = (x | (x << 16U)) & 0x030000ffU;
  bits = (bits | (bits << 8U)) & 0x0300f00fU;
  bits = (bits | (bits << 4U)) & 0x030c30c3U;
  return (bits | (bits << 2U)) & 0x09249249U;
}

/// Computes a triangle's box.
struct BuildLeaf {
  static constexpr std::string_view kName = "build_leaf";
  static constexpr std::string_view kMeaning = "triangle -> its box and build record";
  template <class V>
  struct Ports {
    Local<V, CornersRecord> corners;
    Local<V, LabelRecord> labels;
    Local<V, BoxRecord> boxes;
    Local<V, BuildLeafRecord> leaves;
    I<V> first_number;  ///< number of the batch's first triangle
    static constexpr void describe(auto& p, auto&& port) {
      name_all(port, NAMED_ALL(p.corners, p.labels, p.boxes, p.leaves, p.first_number));
    }
  };
  template <class V>
  static void body(const I<V>& item, Ports<V>& io) {
    const CornersRecord<V> t = io.corners.load(item);
    const LabelRecord<V> label = io.labels.load(item);
    io.boxes.store(item, {min_of<V>(min_of<V>(t.v0, t.v1), t.v2), max_of<V>(max_of<V>(t.v0, t.v1), t.v2)});
    io.leaves.store(item, {t.v0, t.v1, t.v2, io.first_number + item, label.material, label.object});
  }
};

/// Loop-carried corners of a box that grows item by item.
template <class V>
struct RunningBox {
  LoopCarried<V> x0, y0, z0, x1, y1, z1;
  static constexpr void describe(auto& b, auto&& port) {
    name_all(port, NAMED_ALL(b.x0, b.y0, b.z0, b.x1, b.y1, b.z1));
  }
  /// Extends the box to contain the corners `lower` and `upper`, and returns it.
  BoxRecord<V> extend(const Vec3<V>& lower, const Vec3<V>& upper) {
    const Vec3<V> low{min(x0.get(), lower.x), min(y0.get(), lower.y), min(z0.get(), lower.z)};
    const Vec3<V> high{max(x1.get(), upper.x), max(y1.get(), upper.y), max(z1.get(), upper.z)};
    x0.set(low.x), y0.set(low.y), z0.set(low.z), x1.set(high.x), y1.set(high.y), z1.set(high.z);
    return {low, high};
  }
};

/// Computes the bounds of the doubled centres of a batch's boxes. A doubled centre is lower plus upper corner.
struct BoundCentres {
  static constexpr std::string_view kName = "bound_centres";
  static constexpr std::string_view kMeaning = "box -> bounds of the centres up to this item";
  template <class V>
  struct Ports {
    Local<V, BoxRecord> boxes, bounds;
    RunningBox<V> running;
    static constexpr void describe(auto& p, auto&& port) {
      name_all(port, NAMED_ALL(p.boxes, p.bounds));
      RunningBox<V>::describe(p.running, port);
    }
  };
  template <class V>
  static void body(const I<V>& item, Ports<V>& io) {
    const BoxRecord<V> box = io.boxes.load(item);
    const Vec3<V> centre = box.lower + box.upper;
    io.bounds.store(item, io.running.extend(centre, centre));
  }
};

/// Computes the union of the bounds of all batches.
struct BoundBatches {
  static constexpr std::string_view kName = "bound_batches";
  static constexpr std::string_view kMeaning = "bounds of a batch -> bounds of the batches up to it";
  template <class V>
  struct Ports {
    Local<V, BoxRecord> boxes, bounds;
    RunningBox<V> running;
    static constexpr void describe(auto& p, auto&& port) {
      name_all(port, NAMED_ALL(p.boxes, p.bounds));
      RunningBox<V>::describe(p.running, port);
    }
  };
  template <class V>
  static void body(const I<V>& item, Ports<V>& io) {
    const BoxRecord<V> box = io.boxes.load(item);
    io.bounds.store(item, io.running.extend(box.lower, box.upper));
  }
};

/// Lays the cubic grid of Morton codes over the bounds of all centres.
struct MakeGrid {
  static constexpr std::string_view kName = "make_grid";
  static constexpr std::string_view kMeaning = "bounds of all centres -> grid of Morton codes";
  template <class V>
  struct Ports {
    Local<V, BoxRecord> bounds;
    Local<V, GridRecord> grids;
    F<V> cells;  ///< cells per axis
    static constexpr void describe(auto& p, auto&& port) { name_all(port, NAMED_ALL(p.bounds, p.grids, p.cells)); }
  };
  template <class V>
  static void body(const I<V>& item, Ports<V>& io) {
    const BoxRecord<V> bounds = io.bounds.load(item);
    const F<V> extent = max_channel<V>(bounds.upper - bounds.lower);
    io.grids.store(item, {bounds.lower, select(F<V>(0.0F) < extent, io.cells / extent, F<V>(0.0F))});
  }
};

/// Computes the Morton code of a box's centre: 8 or 10 bits per axis, interleaved, x highest.
struct MortonCode {
  static constexpr std::string_view kName = "morton_code";
  static constexpr std::string_view kMeaning = "box -> Morton code of its centre";
  template <class V>
  struct Ports {
    Local<V, BoxRecord> boxes;
    Local<V, KeyRecord> keys;
    Vec3<V> grid_lower;  ///< as GridRecord
    F<V> grid_scale, last_cell;
    I<V> first_number;  ///< number of the batch's first item
    static constexpr void describe(auto& p, auto&& port) {
      name_all(port, NAMED_ALL(p.boxes, p.keys, p.grid_lower, p.grid_scale, p.last_cell, p.first_number));
    }
  };
  template <class V>
  static void body(const I<V>& item, Ports<V>& io) {
    const BoxRecord<V> box = io.boxes.load(item);
    const Vec3<V> cell = (box.lower + box.upper - io.grid_lower) * io.grid_scale;
    const auto code = [&](const F<V>& x) { return spread_bits<V>(to_int(min(max(x, F<V>(0.0F)), io.last_cell))); };
    const I<V> x = code(cell.x) << 2U, y = code(cell.y) << 1U;
    io.keys.store(item, {x | y | code(cell.z), io.first_number + item});
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

/// Writes a leaf record in the format of intersection units. Build records are gathered from memory by number.
struct EncodeLeaf {
  static constexpr std::string_view kName = "encode_leaf";
  static constexpr std::string_view kMeaning = "triangle in leaf order -> its leaf record";
  template <class V>
  struct Ports {
    Local<V, KeyRecord> sorted;
    Stored<V, BuildLeafRecord> stored;
    Local<V, LeafFields> encoded_leaves;
    static constexpr void describe(auto& p, auto&& port) {
      name_all(port, NAMED_ALL(p.sorted, p.stored, p.encoded_leaves));
    }
  };
  template <class V>
  static void body(const I<V>& item, Ports<V>& io) {
    const I<V> number = io.sorted.load(item).number;
    const BuildLeafRecord<V> t = io.stored.load(number);
    io.encoded_leaves.store(item, {t.v0, t.v1, t.v2, t.object, t.material, t.number});
  }
};

/// Computes a triangle's box and leaf record again, after its vertices have moved.
struct RefitLeaf {
  static constexpr std::string_view kName = "refit_leaf";
  static constexpr std::string_view kMeaning = "moved triangle in leaf order -> its box and leaf record";
  template <class V>
  struct Ports {
    Local<V, CornersRecord> corners;
    Local<V, LeafFields> old_leaves;  ///< for their labels
    Local<V, BoxRecord> boxes;
    Local<V, LeafFields> encoded_leaves;
    static constexpr void describe(auto& p, auto&& port) {
      name_all(port, NAMED_ALL(p.corners, p.old_leaves, p.boxes, p.encoded_leaves));
    }
  };
  template <class V>
  static void body(const I<V>& item, Ports<V>& io) {
    const CornersRecord<V> t = io.corners.load(item);
    const LeafFields<V> old = io.old_leaves.load(item);
    io.boxes.store(item, {min_of<V>(min_of<V>(t.v0, t.v1), t.v2), max_of<V>(max_of<V>(t.v0, t.v1), t.v2)});
    io.encoded_leaves.store(item, {t.v0, t.v1, t.v2, old.object, old.material, old.source});
  }
};

/// Writes a node again from the new boxes of its children, and computes its own box. The children of node i have boxes
/// 2 i and 2 i + 1.
struct RefitNode {
  static constexpr std::string_view kName = "refit_node";
  static constexpr std::string_view kMeaning = "node and new boxes of its children -> refitted node and its box";
  template <class V>
  struct Ports {
    Local<V, NodeFields> nodes;
    Local<V, BoxRecord> boxes, fitted;
    Local<V, NodeFields> encoded;
    static constexpr void describe(auto& p, auto&& port) {
      name_all(port, NAMED_ALL(p.nodes, p.boxes, p.fitted, p.encoded));
    }
  };
  template <class V>
  static void body(const I<V>& item, Ports<V>& io) {
    const NodeFields<V> n = io.nodes.load(item);
    const I<V> first = item << 1U;
    const BoxRecord<V> a = io.boxes.load(first);
    const BoxRecord<V> b = io.boxes.load(first + 1U);
    io.fitted.store(item, {min_of<V>(a.lower, b.lower), max_of<V>(a.upper, b.upper)});
    io.encoded.store(item, {a.lower.x, b.lower.x, a.upper.x, b.upper.x, a.lower.y, b.lower.y, a.upper.y, b.upper.y,
                            a.lower.z, b.lower.z, a.upper.z, b.upper.z, n.left_link, n.right_link, 0U, 0U});
  }
};

}  // namespace kernels
