#pragma once
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "hw_models/tni/tni_config.h"
#include "hw_models/tni/tree_in_memory.h"
#include "sim/named.h"
#include "traces/walk.h"

namespace hw {

/// Origin of an entry of a ray's stack: the node whose visit pushed the entry, and the instance to whose tree the node
/// belongs. Instance kNone: the tree over instances.
struct StackEntryOrigin {
  std::uint32_t node = 0;
  std::uint32_t instance = traces::kNone;
};

/// How rays of a traversal unit keep the children that they have yet to visit.
struct StackRules {
  StackScheme scheme = StackScheme::kFull;
  std::uint32_t capacity = ~std::uint32_t{0};  ///< entries of a ray's short stack

  /// True if a restart ends at the next hit child of the node it tested last; false if it ends with a pop.
  bool continues_without_pop() const { return scheme == StackScheme::kRestartTrail || scheme == StackScheme::kParent; }
};

/// The nodes that a ray visits again after a restart, and the instance that the ray enters again. The next node is
/// stored last.
class RestartPath {
 public:
  RestartPath() { path_.reserve(kUsualDepth); }

  /// Computes the path from node `from` down to the node that pushed the youngest stack entry.
  void plan_path(const StackEntryOrigin& youngest, std::uint32_t from, const TreeInMemory& tree);
  /// Computes the path from node `from`, in the tree of `instance`, up to the node `to` that pushed the youngest stack
  /// entry. A ray that leaves an instance returns to world space at no cost.
  void plan_climb(std::uint32_t from, std::uint32_t instance, std::uint32_t to, const TreeInMemory& tree);
  bool is_empty() const { return path_.empty(); }
  bool enters_instance() const { return (path_.back() & kEnter) != 0; }
  std::uint32_t next_instance() const { return path_.back() & ~kEnter; }
  std::uint32_t next_node() const { return path_.back(); }
  void remove_next_step() { path_.pop_back(); }

 private:
  static constexpr std::size_t kUsualDepth = 128;    ///< path length for which memory is reserved
  static constexpr std::uint32_t kEnter = 1U << 31;  ///< bit that marks an instance in the path

  std::vector<std::uint32_t> path_;
};

/// Counters of the ray stacks of a traversal unit.
struct StackStats {
  std::uint64_t pushes = 0, pops = 0, dropped = 0, restarts = 0;
  std::uint64_t entry_updates = 0;
  static void describe(auto& s, auto&& counter) {
    counter(NAMED(s.pushes), "stack entries written", "tni.stack_push");
    counter(NAMED(s.pops), "stack entries read", "tni.stack_pop");
    counter(NAMED(s.dropped), "stack entries dropped because the short stack was full");
    counter(NAMED(s.restarts), "restarts from the link or the root, or climbs to a parent");
    counter(NAMED(s.entry_updates),
            "of the entries read, those written back without their next child (stack_push: node)", "tni.stack_push");
  }
};

}  // namespace hw
