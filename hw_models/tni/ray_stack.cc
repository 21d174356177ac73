#include "hw_models/tni/ray_stack.h"

#include <algorithm>

namespace hw {
namespace {

/// Returns the root of an instance's tree; kNone if `instance` is kNone.
std::uint32_t root_of(std::uint32_t instance, const TreeInMemory& tree) {
  return instance == traces::kNone ? traces::kNone : tree.placed[instance].root;
}

}  // namespace

void RestartPath::plan_path(const StackEntryOrigin& youngest, std::uint32_t from, const TreeInMemory& tree) {
  const std::uint32_t instance = youngest.instance, root = root_of(instance, tree);
  // Follow parents from the youngest entry's node. The parent of an instance's root is in the tree over instances.
  for (std::uint32_t node = youngest.node;;) {
    path_.push_back(node);
    if (node == from) break;
    if (node == root) {
      path_.push_back(kEnter | instance);
      node = tree.parents[tree.node_count() + instance];
    } else {
      node = tree.parents[node];
    }
  }
}

void RestartPath::plan_climb(std::uint32_t from, std::uint32_t instance, std::uint32_t to, const TreeInMemory& tree) {
  const std::uint32_t root = root_of(instance, tree);
  for (std::uint32_t node = from;;) {
    path_.push_back(node);
    if (node == to) break;
    node = node == root ? tree.parents[tree.node_count() + instance] : tree.parents[node];
  }
  std::ranges::reverse(path_);
}

}  // namespace hw
