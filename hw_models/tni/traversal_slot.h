#pragma once
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "hw_models/tni/ray_stack.h"
#include "hw_models/tni/tree_in_memory.h"
#include "traces/walk.h"

namespace hw {

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
/// popped entry. It begins at the node of the oldest dropped entry or, with a restart trail, at the root. With parent
/// links it climbs from the parent of the last child to that origin instead. These visits refill the short stack.
/// 5. A walk that begins at a predicted node visits its subtree with an empty stack. A pop from the empty stack then
/// continues at the root (traces/walk.h).
/// 6. A visit of a wide node enters the first hit child and pushes the others, an entry each; a unit whose entries are
/// nodes keeps them in a NodeStack.
class TraversalSlot {
 public:
  /// The sub-pipe of a traversal unit that a ray's next step needs.
  enum Pipe : std::size_t { kToInner, kToStack, kToLeaf, kToRetire, kPipes };

  TraversalSlot() = default;
  TraversalSlot(const std::uint32_t* walk, std::uint32_t id) : id_(id) { go_to_step(walk); }

  std::uint32_t ray_id() const { return id_; }
  /// Returns the first word of the ray's next step in its recorded walk.
  std::uint32_t next_step() const { return next_step_; }
  /// Returns the last word of the recorded walk that encodes the ray's last completed visit.
  std::uint32_t last_visit() const { return next_word_[-1]; }
  /// Returns the first of the two words that encode the ray's last completed visit of a wide node.
  std::uint32_t last_wide_visit() const { return next_word_[-2]; }
  /// Returns the word of hits of a wide visit, which must be the next step.
  std::uint32_t wide_hits() const { return next_word_[1]; }
  /// Returns the phases with which the triangle tests of a leaf end. The next step must be a leaf.
  std::uint32_t exit_phases() const { return next_word_[1]; }
  bool is_restarting() const { return restarting_; }
  /// True if children are left that the ray has yet to visit. After a predicted node's subtree there are none.
  bool has_entries() const { return stack_depth_ != 0; }
  /// Returns the number of the ray's entries that are in the short stack.
  std::uint32_t resident_entries() const { return short_stack_size_; }
  /// Returns how many of the ray's youngest entries are the next to be discarded, because they begin beyond the hit.
  std::uint32_t known_culls() const { return pending_culls_; }

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
  /// Completes the ray's visit to a wide node. Returns whether the visit hit several children. The arguments are those
  /// of advance_to_next_step().
  [[gnu::always_inline]] bool advance_past_wide_visit(std::uint32_t capacity, bool keeps_entries, StackStats& stats) {
    const std::uint32_t hits = traces::hit_count_of(next_word_[1]);
    go_to_step(next_word_ + 2);
    __builtin_prefetch(next_word_ + 8);  // prefetches later steps of the walk on the host
    must_pop_ = hits == 0;
    const std::uint32_t others = hits - (hits != 0);
    stack_depth_ = static_cast<std::uint16_t>(stack_depth_ + others);
    if (!keeps_entries) return others != 0;
    const std::uint32_t size = short_stack_size_ + others, kept = std::min(size, capacity);
    stats.pushes += others;
    stats.dropped += size - kept;
    short_stack_size_ = static_cast<std::uint16_t>(kept);
    return others != 0;
  }
  /// Completes the ray's transform into an instance's space. The ray continues in the instance's tree.
  void enter_instance() { go_to_step(next_word_ + 1); }
  /// Advances the ray to the step after a leaf that has been sent to the intersection unit.
  void advance_past_leaf() { go_to_step(next_word_ + 2); }
  void take_answer() { must_pop_ = true; }

  /// Pops the youngest entry of the ray's stack. Returns false if the short stack is empty: the ray must restart.
  [[gnu::always_inline]] bool pop_stack_entry(StackStats& stats) {
    if (short_stack_size_ == 0) return continue_at_root();
    stats.pops += 1;
    short_stack_size_ -= 1;
    consume_entry();
    return true;
  }
  /// Continues at the root if traversal of the predicted subtree has ended. Returns true if it had ended.
  bool continue_at_root() {
    if (has_entries()) return false;
    must_pop_ = false;
    return true;
  }
  /// Restarts the traversal of the ray, whose short stack is empty. `walk`: start of its walk. `entries`: scratch
  /// space.
  void restart_walk(const std::uint32_t* walk, const TreeInMemory& tree, const StackRules& rules,
                    std::vector<StackEntryOrigin>& entries, RestartPath& path, StackStats& stats);
  /// Makes the ray repeat the visits of a path, which a NodeStack has planned.
  void begin_restart() { restarting_ = true; }
  /// Completes a node visit that a restarted ray repeats. Returns whether it was the last one.
  bool complete_replayed_visit(RestartPath& path);
  /// Takes the stack's youngest entry. Returns false if it is farther than the ray's hit and therefore discarded.
  bool consume_entry() {
    stack_depth_ -= 1;
    if (pending_culls_ > 0) {
      pending_culls_ -= 1;
      return false;
    }
    must_pop_ = false;
    return true;
  }

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
  Pipe next_pipe_slow_path();
  StackEntryOrigin list_stack_entries(const std::uint32_t* walk, std::vector<StackEntryOrigin>& entries,
                                      std::uint32_t& start) const;

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
