#include "hw_models/tni/treelets.h"

#include <algorithm>

namespace hw {
namespace {

/// Calls f for the link of each child of a node.
void for_each_child(const TreeInMemory& tree, std::uint32_t node, auto&& f) {
  const auto visit = [&](std::span<const std::uint32_t> links) {
    for (const std::uint32_t link : links) {
      if (link != traces::kNoChild) f(link);
    }
  };
  if (tree.kind.wide) return visit(tree.wide_links[node].child);
  visit(tree.links[node].child);
}

}  // namespace

void append_node_lines(const TreeInMemory& tree, std::uint32_t node, std::vector<Addr>& lines) {
  for (std::uint32_t number = 0;; ++number) {
    const TreeInMemory::Line read =
        tree.kind.wide ? tree.line_of_wide_visit((*tree.wide)[node], number) : tree.line_of_visit(node, 2, 0, number);
    if (std::ranges::find(lines, read.line) == lines.end()) lines.push_back(read.line);
    if (read.last) return;
  }
}

Treelets::Treelets(const TreeInMemory& tree, const TrianglesInMemory& triangles, std::uint64_t bytes, Addr map)
    : map_(map), of_node_(tree.node_count(), kNone), of_root_(tree.node_count(), kNone), begin_{0} {
  if (tree.node_count() == 0) return;
  std::vector<std::uint32_t> roots{0};
  for (const traces::InstanceRecord& instance : tree.placed) {
    if (instance.root != traces::kNone) roots.push_back(instance.root);
  }
  std::vector<std::uint32_t> queue;  // nodes of the treelet that are not expanded yet
  std::vector<Addr> lines, longer;
  for (std::size_t next = 0; next < roots.size(); ++next) {  // grows: children that do not fit become roots
    const std::uint32_t root = roots[next];
    if (of_node_[root] != kNone) continue;  // a tree with several instances
    const std::uint32_t treelet = count();
    of_root_[root] = of_node_[root] = treelet;
    lines.clear();
    append_node_lines(tree, root, lines);
    queue.assign(1, root);
    for (std::size_t first = 0; first < queue.size(); ++first) {
      for_each_child(tree, queue[first], [&](std::uint32_t child) {
        if (traces::is_instance(child)) return;
        const bool is_node = !traces::is_leaf(child);
        if (is_node && of_node_[child] != kNone) return;  // a machine without a scene has one node, its own child
        longer = lines;
        if (is_node) {
          append_node_lines(tree, child, longer);
        } else {
          triangles.append_leaf_lines(traces::leaf_first(child), traces::leaf_count(child), longer);
        }
        if (longer.size() * kLineBytes > bytes) {
          if (is_node) roots.push_back(child);
          return;
        }
        std::swap(lines, longer);
        links_.push_back(child);
        if (!is_node) return;
        of_node_[child] = treelet;
        queue.push_back(child);
      });
    }
    begin_.push_back(static_cast<std::uint32_t>(links_.size()));
  }
}

}  // namespace hw
