#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "hw_models/tni/tree_in_memory.h"
#include "sim/named.h"
#include "traces/walk.h"

namespace hw {

/// Where a stack entry of a ray comes from: the node whose visit pushed it, and the instance that the node's tree
/// belongs to. Instance kNone: the tree over instances.
struct StackEntryOrigin {
  std::uint32_t node = 0;
  std::uint32_t instance = traces::kNone;
};

/// The nodes that a ray visits again after a restart, and the instance that it enters again. The next one is at the
/// back.
class RestartPath {
 public:
  RestartPath() { path_.reserve(kUsualDepth); }

  /// Plans the path down to the node of the youngest stack entry. It begins at the root if `from_root`, otherwise at
  /// the node of the oldest entry.
  void plan_path(std::span<const StackEntryOrigin> entries, const TreeInMemory& tree, bool from_root);
  bool is_empty() const { return path_.empty(); }
  bool enters_instance() const { return (path_.back() & kEnter) != 0; }
  std::uint32_t next_instance() const { return path_.back() & ~kEnter; }
  std::uint32_t next_node() const { return path_.back(); }
  void remove_next_step() { path_.pop_back(); }

 private:
  static constexpr std::size_t kUsualDepth = 128;    ///< nodes reserved; deeper trees allocate more
  static constexpr std::uint32_t kEnter = 1U << 31;  ///< marks an instance

  std::vector<std::uint32_t> path_;
};

/// Counters of the stacks of a traversal unit's rays; part of the unit's Stats.
struct StackStats {
  std::uint64_t pushes = 0, pops = 0, dropped = 0, restarts = 0;
  static void describe(auto& s, auto&& counter) {
    counter(NAMED(s.pushes), "stack entries written", "tni.stack_push");
    counter(NAMED(s.pops), "stack entries read", "tni.stack_pop");
    counter(NAMED(s.dropped), "stack entries dropped because the short stack was full");
    counter(NAMED(s.restarts), "restarts from the link or the root");
  }
};

/// A ray in the input buffer of a traversal unit: the state machine that expands the ray's canonical walk through the
/// BVH (traces/walk.h).
///
///   visit: one child hit --> its visit or leaf        leaf, visit without a hit --> pop --> the far child pushed last
///          both hit ------> push far, visit near      no entry left ------------> end
///
/// 1. The next step decides the sub-pipe (next_pipe()); a step after a leaf or after a visit without a hit needs a pop
/// first.
/// 2. A visit that hits both children pushes the far one. In a full short stack the oldest entry is dropped.
/// 3. A popped entry that is farther than the ray's hit is dropped. Each pop is an operation of the stack pipe.
/// 4. A pop from an empty short stack restarts: the ray visits the nodes down to the wanted entry again, from the node
/// of the oldest dropped entry or, with a restart trail, from the root. That refills the short stack.
class TraversalSlot {
 public:
  /// The sub-pipe of a traversal unit that the next step of a ray needs.
  enum Pipe : std::size_t { kToInner, kToStack, kToLeaf, kToRetire, kPipes };

  TraversalSlot() = default;
  TraversalSlot(const std::uint32_t* walk, std::uint32_t id) : id_(id) { go_to_step(walk); }

  std::uint32_t ray_id() const { return id_; }
  /// Returns the first word of the ray's next step.
  std::uint32_t next_step() const { return next_step_; }
  /// Returns the word of the ray's last completed visit.
  std::uint32_t last_visit() const { return next_word_[-1]; }
  /// Returns the phases with which the triangle tests of the next step, a leaf, end.
  std::uint32_t exit_phases() const { return next_word_[1]; }
  bool is_restarting() const { return restarting_; }

  /// Returns the sub-pipe that the ray's next step needs. `instances`: the scene has instances.
  [[gnu::always_inline]] Pipe next_pipe(bool instances = true) {
    // Indexed by kind of step; the second half is for steps that need a pop first.
    static constexpr std::array<Pipe, 8> kPipeOf{kToInner, kToLeaf,  kToStack, kToRetire,
                                                 kToStack, kToStack, kToStack, kToRetire};
    const traces::StepKind kind = traces::kind_of(next_step_);
    if (restarting_ || culls_ > 0 || kind == traces::StepKind::kCull) [[unlikely]]
      return next_pipe_slow_path();
    if (instances && !must_pop_ && traces::is_enter(next_step_)) [[unlikely]]
      return kToInner;
    return kPipeOf[static_cast<std::size_t>(kind) + (must_pop_ ? 4U : 0U)];
  }

  /// Completes a visit and returns whether it hit both children. `capacity`: number of entries of the short stack;
  /// `keeps_entries`: `capacity` is not 0. Branch-free except for a full stack: about half of the visits hit both
  /// children.
  [[gnu::always_inline]] bool advance_to_next_step(std::uint32_t capacity, bool keeps_entries, StackStats& stats) {
    const std::uint32_t hits = traces::hits_of(next_step_);
    go_to_step(next_word_ + 1);
    __builtin_prefetch(next_word_ + 8);  // host prefetch of the ray's later steps
    must_pop_ = hits == 0;
    const unsigned both = hits == 3;
    stack_depth_ = static_cast<std::uint16_t>(stack_depth_ + both);
    if (!keeps_entries) return both != 0;
    stats.pushes += both;
    if (short_stack_size_ != capacity) [[likely]] {
      short_stack_size_ = static_cast<std::uint16_t>(short_stack_size_ + both);
    } else {
      stats.dropped += both;
    }
    return both != 0;
  }
  /// Completes the transform into an instance's space: the ray continues in the instance's tree.
  void enter_instance() { go_to_step(next_word_ + 1); }
  /// Advances past a leaf that has been sent to the intersection unit. The answer is followed by a pop or by the end of
  /// the ray.
  void advance_past_leaf() { go_to_step(next_word_ + 2); }
  void take_answer() { must_pop_ = true; }

  /// Pops the youngest entry of the ray's stack. Returns false if the short stack is empty, so that the ray must
  /// restart.
  [[gnu::always_inline]] bool pop_stack_entry(StackStats& stats) {
    if (short_stack_size_ == 0) return false;
    stats.pops += 1;
    short_stack_size_ -= 1;
    consume_entry();
    return true;
  }
  /// Restarts the traversal of the ray because its short stack is empty. `walk`: first word of the ray's walk.
  /// `entries`: scratch space.
  void restart_walk(const std::uint32_t* walk, const TreeInMemory& tree, bool has_trail, std::uint32_t capacity,
                    std::vector<StackEntryOrigin>& entries, RestartPath& path, StackStats& stats);
  /// Completes a visit that a restarted ray repeats. With a restart trail, the last such visit continues at its far
  /// child without a pop.
  void complete_replayed_visit(RestartPath& path, bool has_trail);

  // Progress of a visit that takes several lines or passes.
  std::uint32_t lines_read() const { return lines_read_; }
  void count_line_read() { lines_read_ += 1; }
  void reset_lines() { lines_read_ = 0; }
  /// Returns which child's box the current pass tests, 0 or 1; for units with one box tester.
  std::uint32_t tested_child() const { return child_; }
  void switch_child() { child_ ^= 1U; }

 private:
  void go_to_step(const std::uint32_t* step) {
    next_word_ = step;
    next_step_ = *step;
  }
  /// Drops a popped stack entry if it is farther than the ray's hit; otherwise the ray continues there.
  void consume_entry() {
    stack_depth_ -= 1;
    if (culls_ > 0) {
      culls_ -= 1;
    } else {
      must_pop_ = false;
    }
  }
  Pipe next_pipe_slow_path();
  void list_entries(const std::uint32_t* walk, std::vector<StackEntryOrigin>& entries) const;

  const std::uint32_t* next_word_ = nullptr;
  std::uint32_t next_step_ = 0;
  std::uint32_t id_ = 0;
  std::uint32_t culls_ = 0;             ///< entries still to be popped and dropped before the next step
  std::uint16_t stack_depth_ = 0;       ///< entries not popped yet, including dropped ones
  std::uint16_t short_stack_size_ = 0;  ///< entries in the short stack
  bool must_pop_ = false;               ///< the next step needs a pop first
  bool restarting_ = false;
  std::uint8_t child_ = 0;
  std::uint8_t lines_read_ = 0;
};
static_assert(sizeof(TraversalSlot) == 32, "two slots per cache line of the host: a tick touches little else");

}  // namespace hw
