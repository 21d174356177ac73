#pragma once
#include <cstdint>
#include <optional>
#include <vector>

#include "hw_models/tni/ray_stack.h"
#include "hw_models/tni/tree_in_memory.h"
#include "traces/walk.h"

namespace hw {

/// A ray's stack for wide trees (stack_push: node). Each entry is a node with its unvisited children, not a single
/// child.
///
///   visit with h hits: enter the first child, push {node, order of the other h - 1}
///   pop: take the next child of the youngest entry; the entry leaves the stack with its last child
///
/// 1. Entries have no distances, so the ray visits each popped child, even if it begins beyond the ray's hit.
/// 2. The object keeps all entries, also those that are not in the short stack: a restart finds them again.
class NodeStack {
 public:
  /// Empties the stack for a ray that begins at node `start`: the root or a predicted node.
  void begin_at(std::uint32_t start);

  /// Pushes an entry for the hit children of a node but the first. `hits`: the walk's word of hits, with at least two.
  void push(std::uint32_t node, std::uint32_t hits, std::uint32_t capacity, StackStats& stats);
  /// Notes that the ray continues at a child of `node`.
  void enter_child_of(std::uint32_t node) { parent_ = node; }
  void enter_instance(std::uint32_t instance) { instance_ = instance; }
  /// Takes the next child of the youngest entry. Returns its link, or none if the short stack is empty.
  std::optional<std::uint32_t> pop(const TreeInMemory& tree, StackStats& stats);
  /// Takes the next child at the end of a restart, which has just tested the node of the youngest entry.
  std::uint32_t take_child(const TreeInMemory& tree);

  /// Returns the number of unvisited children of the entries that are in the short stack.
  std::uint32_t resident_children() const;

  /// Plans the visits of a restart and refills the short stack as these visits will.
  void restart(const StackRules& rules, const TreeInMemory& tree, RestartPath& path, StackStats& stats);

 private:
  struct Entry {
    StackEntryOrigin origin;
    std::uint32_t slots =
        0;  ///< slot numbers of the remaining children in visiting order, the next child in the lowest bits
    std::uint32_t left = 0;  ///< number of remaining children
  };

  std::vector<Entry> entries_;
  std::uint32_t start_ = 0;                 ///< node at which the ray has begun
  std::uint32_t resident_ = 0;              ///< number of youngest entries that are in the short stack
  std::uint32_t instance_ = traces::kNone;  ///< instance in whose tree the ray is
  std::uint32_t parent_ = 0;                ///< parent of the node that the ray visits or visited last
};

}  // namespace hw
