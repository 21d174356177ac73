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

/// Origin of an entry of a ray's stack: the node whose visit pushed the entry, and the instance to whose tree the node
/// belongs. Instance kNone: the tree over instances.
struct StackEntryOrigin {
  std::uint32_t node = 0;
  std::uint32_t instance = traces::kNone;
};

/// The nodes that a ray visits again after a restart, and the instance that the ray enters again. The next node is
/// stored last.
class RestartPath {
 public:
  RestartPath() { path_.reserve(kUsualDepth); }

  /// Computes the path down to the node that pushed the youngest stack entry. The path begins at the root if
  /// `from_root`, otherwise at the node that pushed the oldest entry.
  void plan_path(std::span<const StackEntryOrigin> entries, const TreeInMemory& tree, bool from_root);
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
/// 1. The next step of the walk decides which sub-pipe the ray needs (next_pipe()). After a leaf, or after a visit
/// without a hit, the ray needs a pop first.
/// 2. A visit that hits both children pushes the far child. If the short stack is full, its oldest entry is dropped.
/// 3. A popped entry that is farther than the ray's hit is discarded. Each pop is an operation of the stack pipe.
/// 4. A pop from an empty short stack restarts the traversal: the ray again visits the nodes down to the origin of the
/// popped entry. It begins at the node of the oldest dropped entry or, with a restart trail, at the root. These visits
/// refill the short stack.
class TraversalSlot {
 public:
  /// The sub-pipe of a traversal unit that a ray's next step needs.
  enum Pipe : std::size_t { kToInner, kToStack, kToLeaf, kToRetire, kPipes };

  TraversalSlot() = default;
  TraversalSlot(const std::uint32_t* walk, std::uint32_t id) : id_(id) { go_to_step(walk); }

  std::uint32_t ray_id() const { return id_; }
  /// Returns the first word of the ray's next step in its recorded walk.
  std::uint32_t next_step() const { return next_step_; }
  /// Returns the word of the recorded walk that encodes the ray's last completed visit.
  std::uint32_t last_visit() const { return next_word_[-1]; }
  /// Returns the phases with which the triangle tests of a leaf end. The next step must be a leaf.
  std::uint32_t exit_phases() const { return next_word_[1]; }
  bool is_restarting() const { return restarting_; }

  /// Returns the sub-pipe that the ray's next step needs. `may_enter_instance`: false if the scene has no
  /// instances.
  [[gnu::always_inline]] Pipe next_pipe(bool may_enter_instance = true) {
    // Indexed by kind of step. The second half is used if a pop must precede the step.
    static constexpr std::array<Pipe, 8> kPipeOf{kToInner, kToLeaf,  kToStack, kToRetire,
                                                 kToStack, kToStack, kToStack, kToRetire};
    const traces::StepKind kind = traces::kind_of(next_step_);
    if (restarting_ || pending_culls_ > 0 || kind == traces::StepKind::kCull) [[unlikely]]
      return next_pipe_slow_path();
    if (may_enter_instance && !must_pop_ && traces::is_enter(next_step_)) [[unlikely]]
      return kToInner;
    return kPipeOf[static_cast<std::size_t>(kind) + (must_pop_ ? 4U : 0U)];
  }

  /// Completes the ray's visit to a node. Returns whether the visit hit both children, which is unpredictable: so the
  /// code is branch-free except for a full stack. `capacity`: capacity of the short stack. `keeps_entries`: `capacity`
  /// is not 0.
  [[gnu::always_inline]] bool advance_to_next_step(std::uint32_t capacity, bool keeps_entries, StackStats& stats) {
    const std::uint32_t hits = traces::hits_of(next_step_);
    go_to_step(next_word_ + 1);
    __builtin_prefetch(next_word_ + 8);  // prefetches later steps of the walk on the host
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
  /// Completes the ray's transform into an instance's space. The ray continues in the instance's tree.
  void enter_instance() { go_to_step(next_word_ + 1); }
  /// Advances the ray to the step after a leaf that has been sent to the intersection unit.
  void advance_past_leaf() { go_to_step(next_word_ + 2); }
  void take_answer() { must_pop_ = true; }

  /// Pops the youngest entry of the ray's stack. Returns false if the short stack is empty: the ray must restart.
  [[gnu::always_inline]] bool pop_stack_entry(StackStats& stats) {
    if (short_stack_size_ == 0) return false;
    stats.pops += 1;
    short_stack_size_ -= 1;
    consume_entry();
    return true;
  }
  /// Restarts the traversal of the ray, whose short stack is empty. `walk`: start of its walk. `entries`: scratch
  /// space.
  void restart_walk(const std::uint32_t* walk, const TreeInMemory& tree, bool has_trail, std::uint32_t capacity,
                    std::vector<StackEntryOrigin>& entries, RestartPath& path, StackStats& stats);
  /// Completes a node visit that a restarted ray repeats. With a restart trail, the last repeated visit continues at
  /// its far child without a pop.
  void complete_replayed_visit(RestartPath& path, bool has_trail);

  // Progress of a node visit that reads several lines or takes several passes.
  std::uint32_t lines_read() const { return lines_read_; }
  void count_line_read() { lines_read_ += 1; }
  void reset_lines() { lines_read_ = 0; }
  /// Returns the child (0 or 1) whose box the current pass of a visit tests, in a unit with one box tester.
  std::uint32_t tested_child() const { return child_; }
  void switch_to_other_child() { child_ ^= 1U; }

 private:
  void go_to_step(const std::uint32_t* step) {
    next_word_ = step;
    next_step_ = *step;
  }
  /// Discards a popped stack entry if it is farther than the ray's hit. Otherwise the ray continues at the entry.
  void consume_entry() {
    stack_depth_ -= 1;
    if (pending_culls_ > 0) {
      pending_culls_ -= 1;
    } else {
      must_pop_ = false;
    }
  }
  Pipe next_pipe_slow_path();
  void list_stack_entries(const std::uint32_t* walk, std::vector<StackEntryOrigin>& entries) const;

  const std::uint32_t* next_word_ = nullptr;
  std::uint32_t next_step_ = 0;
  std::uint32_t id_ = 0;
  std::uint32_t pending_culls_ = 0;     ///< stack entries to be popped and discarded before the next step
  std::uint16_t stack_depth_ = 0;       ///< entries pushed and not popped, including those dropped from the short stack
  std::uint16_t short_stack_size_ = 0;  ///< number of the ray's entries that are in the short stack
  bool must_pop_ = false;               ///< the ray needs a pop before its next step
  bool restarting_ = false;
  std::uint8_t child_ = 0;
  std::uint8_t lines_read_ = 0;
};
static_assert(sizeof(TraversalSlot) == 32, "two slots per cache line of the host: a tick touches little else");

}  // namespace hw
