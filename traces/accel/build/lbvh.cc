#include "traces/accel/build/lbvh.h"

#include <bit>
#include <cstdint>
#include <utility>
#include <vector>

#include "traces/accel/build/morton_order.h"

namespace traces {
namespace {

/// Returns the level of the split between positions i - 1 and i: larger if a higher bit of the codes differs. Positions
/// are the lower bits of a code.
int split_level(const std::vector<std::uint64_t>& codes, std::uint32_t i) {
  const std::uint64_t different = codes[i - 1] ^ codes[i];
  return different != 0 ? 96 - std::countl_zero(different) : 32 - std::countl_zero((i - 1) ^ i);
}

}  // namespace

/// Within a range the highest split level occurs once, so the tree is the one whose levels fall from parents to
/// children. One pass over the positions builds it: `path` has the finished subtrees of the rightmost path, and the
/// levels of the splits before them.
BinaryTree build_lbvh(std::span<const Bounds> boxes, const BvhConfig& config, sim::Stop stop) {
  BinaryTree tree;
  MortonOrder order = morton_order(boxes, config.morton_bits);
  if (stop != nullptr && stop()) throw sim::Cancelled{};
  tree.items = std::move(order.items);
  tree.boxes.reserve(boxes.size());
  for (const std::uint32_t item : tree.items) tree.boxes.push_back(boxes[item]);
  tree.nodes.reserve(boxes.size());

  struct Subtree {
    std::uint32_t link;
    int level;
  };
  std::vector<Subtree> path;
  const auto merge_last_two = [&] {
    const std::uint32_t second = path.back().link;
    path.pop_back();
    tree.add_parent(path.back().link, second);
    path.back().link = static_cast<std::uint32_t>(tree.nodes.size()) - 1;
  };
  for (std::uint32_t i = 0; i < boxes.size(); ++i) {
    const int level = i == 0 ? 0 : split_level(order.codes, i);
    while (path.size() > 1 && path.back().level < level) merge_last_two();
    path.push_back({leaf_link(i, 1), level});
  }
  while (path.size() > 1) merge_last_two();
  return tree;
}

}  // namespace traces
