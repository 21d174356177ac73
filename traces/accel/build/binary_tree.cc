#include "traces/accel/build/binary_tree.h"

#include <algorithm>
#include <functional>
#include <iterator>
#include <span>
#include <string>

#include "sim/error.h"
#include "traces/accel/build/append_tree.h"

namespace traces {
namespace {

Bounds merged_box(Bounds a, const Bounds& b) {
  a.add(b.lower);
  a.add(b.upper);
  return a;
}

/// Decides which subtrees become leaves, and keeps the tree within its depth.
class LeafMerger {
 public:
  LeafMerger(BinaryTree& tree, const BvhConfig& config) : tree_(tree), config_(config), nodes_(tree.nodes.size()) {
    for (std::uint32_t i = 0; i < nodes_.size(); ++i) measure_node(i);
  }

  bool is_leaf(std::uint32_t link) const { return traces::is_leaf(link) || nodes_[link].is_merged; }

  /// Rebuilds subtrees until no path has more than `config.max_depth` inner nodes.
  void limit_depth() {
    const auto items = static_cast<std::uint32_t>(tree_.items.size());
    if (!fits_depth(items, config_.max_depth)) {
      throw sim::InputError("bvh.max_depth: " + std::to_string(config_.max_depth) + " levels are not enough for " +
                            std::to_string(items) + " triangles in leaves of " + std::to_string(config_.leaf_size));
    }
    if (!nodes_.empty()) limit_depth(static_cast<std::uint32_t>(nodes_.size()) - 1, config_.max_depth);
  }

 private:
  struct NodeInfo {
    double cost = 0;  ///< expected cost of the subtree times its area
    std::uint32_t items = 0;
    std::uint32_t height = 0;  ///< inner nodes on the longest path down; 0 for a merged subtree
    bool is_merged = false;    ///< becomes a leaf
  };

  NodeInfo info_of(std::uint32_t link) const {
    if (!traces::is_leaf(link)) return nodes_[link];
    return {config_.intersection_cost * half_surface(tree_.box_of(link)), 1, 0, true};
  }

  void measure_node(std::uint32_t index) {
    const BinaryTree::Node& node = tree_.nodes[index];
    const NodeInfo a = info_of(node.child[0]), b = info_of(node.child[1]);
    const double area = half_surface(node.box);
    NodeInfo& all = nodes_[index];
    all.items = a.items + b.items;
    all.height = 1 + std::max(a.height, b.height);
    all.cost = area * config_.traversal_cost + a.cost + b.cost;
    const double as_leaf = area * config_.intersection_cost * all.items;
    if (all.items > config_.leaf_size || as_leaf > all.cost) return;
    all.cost = as_leaf;
    all.height = 0;
    all.is_merged = true;
  }

  /// True if median splits put the items into full leaves below at most `levels` inner nodes.
  bool fits_depth(std::uint32_t items, std::uint32_t levels) const {
    return levels >= 32 || items <= (std::uint64_t{config_.leaf_size} << levels);
  }

  /// Limits the height of the subtree of node `index`, whose items fit, to `levels`.
  void limit_depth(std::uint32_t index, std::uint32_t levels) {
    if (nodes_[index].height <= levels) return;
    const auto& child = tree_.nodes[index].child;
    const auto fits = [&](std::uint32_t link) { return fits_depth(info_of(link).items, levels - 1); };
    if (levels > 0 && std::ranges::all_of(child, fits)) {
      for (const std::uint32_t link : child) {
        if (!traces::is_leaf(link)) limit_depth(link, levels - 1);
      }
      return;
    }
    std::vector<std::uint32_t> positions;
    spare_.clear();
    collect_subtree(index, positions);
    std::ranges::sort(positions);
    split_at_medians(positions);
  }

  /// Collects the positions of a subtree's items, and its nodes, parents before children.
  void collect_subtree(std::uint32_t root, std::vector<std::uint32_t>& positions) {
    std::vector<std::uint32_t> links{root};
    while (!links.empty()) {
      const std::uint32_t link = links.back();
      links.pop_back();
      if (traces::is_leaf(link)) {
        positions.push_back(leaf_first(link));
      } else {
        spare_.push_back(link);
        links.insert(links.end(), std::begin(tree_.nodes[link].child), std::end(tree_.nodes[link].child));
      }
    }
    std::ranges::sort(spare_, std::greater<>());  // the root first
    next_spare_ = 0;
  }

  /// Builds a tree over items from spare nodes and returns the link word of its root.
  std::uint32_t split_at_medians(std::span<const std::uint32_t> positions) {
    if (positions.size() == 1) return leaf_link(positions.front(), 1);
    const std::uint32_t index = spare_[next_spare_++];
    const std::size_t half = (positions.size() + 1) / 2;
    BinaryTree::Node& node = tree_.nodes[index];
    node.child[0] = split_at_medians(positions.first(half));
    node.child[1] = split_at_medians(positions.subspan(half));
    node.box = merged_box(tree_.box_of(node.child[0]), tree_.box_of(node.child[1]));
    NodeInfo& info = nodes_[index];
    info.items = static_cast<std::uint32_t>(positions.size());
    info.is_merged = info.items <= config_.leaf_size;
    return index;
  }

  BinaryTree& tree_;
  const BvhConfig& config_;
  std::vector<NodeInfo> nodes_;
  std::vector<std::uint32_t> spare_;  ///< nodes of a subtree that is rebuilt
  std::size_t next_spare_ = 0;
};

/// The tree as append_subtree() reads it.
struct MergedTree {
  const BinaryTree& tree;
  const LeafMerger& merger;

  bool is_leaf(std::uint32_t link) const { return merger.is_leaf(link); }
  std::uint32_t child(std::uint32_t link, int i) const { return tree.nodes[link].child[i]; }
  const Bounds& box(std::uint32_t link, int i) const { return tree.box_of(child(link, i)); }
  void append_items(std::uint32_t link, std::vector<std::uint32_t>& order) const {
    if (traces::is_leaf(link)) return order.push_back(tree.items[leaf_first(link)]);
    for (int i = 0; i < 2; ++i) append_items(child(link, i), order);
  }
};

}  // namespace

void BinaryTree::add_parent(std::uint32_t first, std::uint32_t second) {
  nodes.push_back({merged_box(box_of(first), box_of(second)), {first, second}});
}

FlatBvh flatten_tree(BinaryTree& tree, const BvhConfig& config) {
  if (tree.items.empty()) return empty_tree();
  LeafMerger merger(tree, config);
  merger.limit_depth();
  const auto root = tree.nodes.empty() ? leaf_link(0, 1) : static_cast<std::uint32_t>(tree.nodes.size()) - 1;
  return flat_tree(MergedTree{tree, merger}, root, tree.box_of(root), tree.items.size());
}

}  // namespace traces
