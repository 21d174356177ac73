#include "traces/accel/build/collapse.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <limits>
#include <span>

#include "traces/accel/wide_format.h"

namespace traces {
namespace {

/// A child of a wide node while its node is formed.
struct Child {
  std::uint32_t link = kNoChild;
  Bounds box;
};

/// A box of a binary node.
Bounds box_of(const NodeRecord& node, int child) {
  return {{node.x[child], node.y[child], node.z[child]}, {node.x[2 + child], node.y[2 + child], node.z[2 + child]}};
}

/// The children of a wide node, at most kMaxWidth.
class Children {
 public:
  void push_back(const Child& child) { all_[count_++] = child; }
  /// Replaces child `i` by two children, in its place.
  void replace(std::size_t i, const Child& a, const Child& b) {
    std::copy_backward(all_.begin() + static_cast<std::ptrdiff_t>(i) + 1, all_.begin() + count_,
                       all_.begin() + count_ + 1);
    all_[i] = a;
    all_[i + 1] = b;
    ++count_;
  }
  std::size_t size() const { return static_cast<std::size_t>(count_); }
  const Child& operator[](std::size_t i) const { return all_[i]; }
  std::span<const Child> all() const { return std::span(all_).first(size()); }

 private:
  std::array<Child, kMaxWidth + 1> all_;
  std::ptrdiff_t count_ = 0;
};

/// Chooses the children of wide nodes by area.
class AreaCollapse {
 public:
  AreaCollapse(const FlatBvh& binary, const BvhConfig& config) : nodes_(binary.nodes), width_(config.width) {}

  /// Returns the children of the wide node that begins at binary node `index`.
  Children children_of(std::uint32_t index) const {
    Children children;
    for (int c = 0; c < 2; ++c) {
      if (nodes_[index].child[c] != kNoChild) children.push_back(child_of(index, c));
    }
    while (children.size() < width_) {
      std::size_t largest = children.size();
      double area = -1;
      for (std::size_t i = 0; i < children.size(); ++i) {
        if (is_leaf(children[i].link) || half_surface(children[i].box) <= area) continue;
        largest = i;
        area = half_surface(children[i].box);
      }
      if (largest == children.size()) break;
      const std::uint32_t opened = children[largest].link;
      children.replace(largest, child_of(opened, 0), child_of(opened, 1));
    }
    return children;
  }

 private:
  Child child_of(std::uint32_t index, int c) const { return {nodes_[index].child[c], box_of(nodes_[index], c)}; }

  const std::vector<NodeRecord>& nodes_;
  const std::size_t width_;
};

/// Chooses the children of wide nodes of least expected cost.
///
/// cost(n, k) is the least cost of the subtree of binary node n as at most k children of a wide node. One child is a
/// leaf of all its triangles, if they are few enough, or an inner wide node, whose children are the best split of the
/// width over n's two children. More children are the best split of k over them.
class SahCollapse {
 public:
  SahCollapse(const FlatBvh& binary, const BvhConfig& config, std::uint32_t most_merged)
      : nodes_(binary.nodes), config_(config), width_(config.width), most_merged_(most_merged) {
    const bool bytes = config.collapse_cost == CollapseCost::kBytes;
    node_cost_ = bytes ? wide_node_bytes(config.node_format(), config.width) : config.traversal_cost;
    for (std::uint32_t n = 1; n <= kMaxLeafTriangles; ++n) {
      leaf_cost_[n] = bytes ? expected_leaf_bytes(config, n) : config.intersection_cost * n;
    }
    measure_nodes();
    costs_.resize(nodes_.size());
    for (std::size_t i = nodes_.size(); i-- > 0;) set_costs(static_cast<std::uint32_t>(i));
  }

  Children children_of(std::uint32_t index) const {
    Children children;
    if (nodes_[index].child[1] == kNoChild) {  // the root of an empty tree or of a single leaf
      if (nodes_[index].child[0] != kNoChild) children.push_back({nodes_[index].child[0], box_of(nodes_[index], 0)});
      return children;
    }
    distribute(index, width_, children);
    return children;
  }

 private:
  using Costs = std::array<float, kMaxWidth>;  ///< cost(n, k) at k - 1

  struct Range {
    std::uint32_t first = 0, count = 0;
  };

  void measure_nodes() {
    area_.resize(nodes_.size());
    triangles_.resize(nodes_.size());
    for (std::size_t i = nodes_.size(); i-- > 0;) {
      const NodeRecord& node = nodes_[i];
      Bounds box;
      for (int c = 0; c < 2; ++c) {
        const std::uint32_t link = node.child[c];
        if (link == kNoChild) continue;
        const Bounds b = box_of(node, c);
        box.add(b.lower);
        box.add(b.upper);
        const Range below = is_leaf(link) ? Range{leaf_first(link), leaf_count(link)} : triangles_[link];
        if (c == 0) triangles_[i].first = below.first;
        triangles_[i].count += below.count;
      }
      area_[i] = half_surface(box);
    }
  }

  void set_costs(std::uint32_t index) {
    Costs& costs = costs_[index];
    if (nodes_[index].child[1] == kNoChild) return;
    costs[0] = static_cast<float>(std::min(leaf_cost(index), inner_cost(index)));
    for (std::uint32_t k = 2; k <= width_; ++k) costs[k - 1] = std::min(costs[k - 2], split_cost(index, k).cost);
  }
  double leaf_cost(std::uint32_t index) const {
    const std::uint32_t n = triangles_[index].count;
    return n <= most_merged_ ? area_[index] * leaf_cost_[n] : std::numeric_limits<double>::infinity();
  }
  double inner_cost(std::uint32_t index) const { return area_[index] * node_cost_ + split_cost(index, width_).cost; }

  /// Returns cost(n, k) of child `c` of a node.
  float child_cost(std::uint32_t index, int c, std::uint32_t k) const {
    const std::uint32_t link = nodes_[index].child[c];
    if (!is_leaf(link)) return costs_[link][k - 1];
    return static_cast<float>(half_surface(box_of(nodes_[index], c)) * leaf_cost_[leaf_count(link)]);
  }

  struct Split {
    float cost = std::numeric_limits<float>::infinity();
    std::uint32_t first = 1;  ///< slots of child 0
  };
  /// Returns the best split of `k` slots over the two children of a node.
  Split split_cost(std::uint32_t index, std::uint32_t k) const {
    Split best;
    for (std::uint32_t first = 1; first < k; ++first) {
      const float cost = child_cost(index, 0, first) + child_cost(index, 1, k - first);
      if (cost < best.cost) best = {cost, first};
    }
    return best;
  }

  void distribute(std::uint32_t index, std::uint32_t k, Children& children) const {
    const Split split = split_cost(index, k);
    add_child(index, 0, split.first, children);
    add_child(index, 1, k - split.first, children);
  }
  /// Adds child `c` of a node as at most `k` children.
  void add_child(std::uint32_t index, int c, std::uint32_t k, Children& children) const {
    const std::uint32_t link = nodes_[index].child[c];
    if (is_leaf(link)) return children.push_back({link, box_of(nodes_[index], c)});
    while (k > 1 && costs_[link][k - 1] == costs_[link][k - 2]) --k;
    if (k > 1) return distribute(link, k, children);
    const bool merges = leaf_cost(link) <= inner_cost(link);
    const Range& all = triangles_[link];
    children.push_back({merges ? leaf_link(all.first, all.count) : link, box_of(nodes_[index], c)});
  }

  const std::vector<NodeRecord>& nodes_;
  const BvhConfig& config_;
  const std::uint32_t width_, most_merged_;
  double node_cost_ = 1;
  std::array<double, kMaxLeafTriangles + 1> leaf_cost_{};
  std::vector<double> area_;      ///< half the surface area of each binary node
  std::vector<Range> triangles_;  ///< the triangles below each binary node
  std::vector<Costs> costs_;
};

WideNode empty_node() {
  WideNode node;
  for (std::uint32_t slot = 0; slot < kMaxWidth; ++slot) {
    set_box(node, slot, Bounds{});
    node.child[slot] = kNoChild;
  }
  return node;
}

/// Returns the slot of each child: the first ones, or octant slots.
std::array<std::uint32_t, kMaxWidth> slots_of(const Children& children, NodeFormat format) {
  std::array<std::uint32_t, kMaxWidth> slots{0, 1, 2, 3, 4, 5, 6, 7};
  if (format != NodeFormat::kCw80) return slots;
  Bounds all;
  for (const Child& child : children.all()) {
    all.add(child.box.lower);
    all.add(child.box.upper);
  }
  std::array<glm::vec3, kMaxWidth> centres{};
  for (std::size_t i = 0; i < children.size(); ++i) centres[i] = children[i].box.centre() - all.centre();
  return octant_slots(std::span(centres).first(children.size()));
}

template <class Chooser>
class Collapser {
 public:
  Collapser(const FlatBvh& binary, const Chooser& chooser, NodeFormat format)
      : binary_(binary), chooser_(chooser), format_(format) {}

  WideBvh run() {
    out_.order.reserve(binary_.order.size());
    out_.nodes.push_back(empty_node());
    fill_node(0, 0);
    return std::move(out_);
  }

 private:
  /// Forms wide node `to` from binary node `from`, and all nodes below it.
  void fill_node(std::uint32_t to, std::uint32_t from) {
    const Children children = chooser_.children_of(from);
    const auto slots = slots_of(children, format_);
    WideNode node = empty_node();
    for (std::size_t i = 0; i < children.size(); ++i) {
      node.child[slots[i]] = children[i].link;
      set_box(node, slots[i], children[i].box);
    }
    // Slots in order: numbers of inner children and triangles of leaves follow each other.
    const auto first = static_cast<std::uint32_t>(out_.nodes.size());
    std::array<std::uint32_t, kMaxWidth> inner{};
    std::uint32_t count = 0;
    for (std::uint32_t& link : node.child) {
      if (link == kNoChild) continue;
      if (is_leaf(link)) {
        const auto begin = static_cast<std::uint32_t>(out_.order.size());
        for (std::uint32_t i = 0; i < leaf_count(link); ++i) out_.order.push_back(binary_.order[leaf_first(link) + i]);
        link = leaf_link(begin, leaf_count(link));
      } else {
        inner[count] = link;
        link = first + count++;
      }
    }
    out_.nodes[to] = node;
    out_.nodes.resize(first + count, empty_node());
    for (std::uint32_t i = 0; i < count; ++i) fill_node(first + i, inner[i]);
  }

  const FlatBvh& binary_;
  const Chooser& chooser_;
  const NodeFormat format_;
  WideBvh out_;
};

}  // namespace

WideBvh collapse_tree(const FlatBvh& binary, const BvhConfig& config, std::uint32_t most_merged) {
  if (config.collapse == Collapse::kArea) {
    return Collapser(binary, AreaCollapse(binary, config), config.node_format()).run();
  }
  return Collapser(binary, SahCollapse(binary, config, most_merged), config.node_format()).run();
}

double expected_leaf_bytes(const BvhConfig& config, std::uint32_t triangles) {
  switch (config.leaf) {
    case LeafFormat::kTriangles:
      return static_cast<double>(config.triangle_bytes) * triangles;
    case LeafFormat::kPair64:
      return 64.0 * ((triangles + 1) / 2);
    case LeafFormat::kBlock128:
      return 128.0;
  }
  return 0;
}

}  // namespace traces
