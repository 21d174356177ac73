#pragma once
#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>

namespace traces {

// The canonical walk of a ray visits the near child first, has an unlimited stack and tests both boxes per visit. It is
// independent of stack scheme, caches and addresses; the machine model adds those. A walk is a sequence of 32-bit words
// that ends with kEnd:
//
//   visit  00 | near(1) | hits(2) | node(27)      an inner node is tested; bit 0 of `hits` is child 0, bit 1 child 1;
//                                                  `near` is the child entered first when both are hit
//   wide   00 | 1 | 00 | node(27)                  an inner node of a wide tree is tested, all children at once; the
//                                                  next word is mask(8) | slots(8 x 3): bit i of `mask` is set if the
//                                                  child in slot i is hit; the lowest three bits of `slots` are the
//                                                  slot of the hit child that is entered, then of the next one, and so
//                                                  on; slots beyond the hit children are 0
//   leaf   01 | count(4) | first triangle(26)      a leaf is entered and `count` triangles are tested (a shadow ray
//                                                  stops after a hit without flags, ray.h); the next word has the
//                                                  exit phase of each test, 4 bits each, first test lowest
//   enter  01 | 0(4) | instance(26)                the ray enters the space of an instance, at the root of its tree
//   cull   10 | n(30)                              n stack entries are popped and dropped: they begin beyond the hit
//   look   10 | 1 | correct(1) | stored(1) | node(27)
//                                                  before the first visit: the ray looks up a predicted node
//                                                  (accel/ray_predictor.h), or kNoPrediction; `correct` is 1 if the
//                                                  ray ends below the node; `stored` is 1 if its hit updates the table
//   end    11 | hit(1)
//
// A leaf, or a visit without a hit, is followed by a pop or the end. A visit that hits both children pushes the far
// one. A wide visit enters the first of the hit children and pushes the others, the last first. Trees of more than two
// children per node, and of quantised boxes, have wide visits only; other trees have none. A cull counts children in
// both. An enter is followed by the visit of that root. Leaving an instance has no word: the ray returns to world space
// when an entry is popped that was on the stack before it entered.
//
// After a look-up that finds a node, the ray begins there instead of at the root. Until it has left the node's subtree
// it ignores hits of triangles with flags. If no hit ends it there, the pop from the empty stack is followed by the
// visit of the root, and the walk continues as if it had begun there.

enum class StepKind : std::uint32_t { kVisit = 0, kLeaf = 1, kCull = 2, kEnd = 3 };

/// The phase of a triangle test in which the test ended. A hit passes all three phases.
enum class ExitPhase : std::uint32_t { kDistance = 1, kBarycentric = 2, kHit = 3 };

inline constexpr std::uint32_t kNodeBits = 27;
inline constexpr std::uint32_t kMaxNodes = 1U << kNodeBits;
inline constexpr std::uint32_t kMaxTriangles = 1U << 26;
inline constexpr std::uint32_t kMaxLeafTriangles = 8;

constexpr StepKind kind_of(std::uint32_t word) { return static_cast<StepKind>(word >> 30); }

constexpr std::uint32_t visit_step(std::uint32_t node, std::uint32_t hits, std::uint32_t near) {
  return (near << 29) | (hits << 27) | node;
}
constexpr std::uint32_t node_of(std::uint32_t word) { return word & (kMaxNodes - 1); }
constexpr std::uint32_t hits_of(std::uint32_t word) { return (word >> 27) & 3U; }
constexpr std::uint32_t near_of(std::uint32_t word) { return (word >> 29) & 1U; }

// Wide visits. A binary visit never has `near` without two hits, so the first word distinguishes both kinds.
inline constexpr std::uint32_t kMaxWidth = 8;
inline constexpr std::uint32_t kSlotBits = 3;
static_assert(kMaxWidth == 1U << kSlotBits && kMaxWidth + kMaxWidth * kSlotBits == 32);
constexpr std::uint32_t wide_step(std::uint32_t node) { return visit_step(node, 0, 1); }
constexpr bool is_wide(std::uint32_t word) { return word >> 27 == 4; }
/// Returns the word after wide_step(): which children are hit, and their slots, the nearest in the lowest bits.
constexpr std::uint32_t wide_hits(std::uint32_t mask, std::uint32_t slots) { return mask << (32 - kMaxWidth) | slots; }
constexpr std::uint32_t hit_mask_of(std::uint32_t hits) { return hits >> (32 - kMaxWidth); }
constexpr std::uint32_t hit_count_of(std::uint32_t hits) {
  return static_cast<std::uint32_t>(std::popcount(hit_mask_of(hits)));
}
/// Returns the slot of the hit child at a position, 0 for the nearest.
constexpr std::uint32_t hit_slot_of(std::uint32_t hits, std::uint32_t position) {
  return hits >> (kSlotBits * position) & (kMaxWidth - 1);
}

constexpr std::uint32_t leaf_step(std::uint32_t first, std::uint32_t count) {
  return (1U << 30) | (count << 26) | first;
}
constexpr std::uint32_t instance_step(std::uint32_t instance) { return leaf_step(instance, 0); }
constexpr bool is_enter(std::uint32_t word) { return word >> 26 == 1U << 4; }
constexpr std::uint32_t instance_index_of(std::uint32_t word) { return word & (kMaxTriangles - 1); }
constexpr std::uint32_t first_of(std::uint32_t word) { return word & (kMaxTriangles - 1); }
constexpr std::uint32_t count_of(std::uint32_t word) { return (word >> 26) & 15U; }
constexpr ExitPhase phase_of(std::uint32_t phases, std::uint32_t test) {
  return static_cast<ExitPhase>((phases >> (4 * test)) & 15U);
}

constexpr std::uint32_t cull_step(std::uint32_t n) { return (2U << 30) | n; }
constexpr std::uint32_t culled_of(std::uint32_t word) { return word & ((1U << 30) - 1); }

/// Node of a look-up that found none.
inline constexpr std::uint32_t kNoPrediction = kMaxNodes - 1;
constexpr std::uint32_t look_up_step(std::uint32_t node, bool correct, bool stored) {
  return (5U << 29) | (correct ? 1U << 28 : 0U) | (stored ? 1U << 27 : 0U) | node;
}
constexpr bool is_look_up(std::uint32_t word) { return word >> 29 == 5; }
constexpr bool is_correct_look_up(std::uint32_t word) { return (word >> 28 & 1U) != 0; }
constexpr bool stores_hit(std::uint32_t word) { return (word >> 27 & 1U) != 0; }

constexpr std::uint32_t end_step(bool hit) { return (3U << 30) | (hit ? 1U : 0U); }

/// Counts of canonical traversal steps: nodes visited and triangles tested.
struct WalkSteps {
  std::uint64_t visits = 0, tests = 0;
  std::uint64_t enters = 0;  ///< instances entered, which do not count as steps
  std::uint64_t total_steps() const { return visits + tests; }
  WalkSteps& operator+=(const WalkSteps& other) {
    visits += other.visits;
    tests += other.tests;
    enters += other.enters;
    return *this;
  }
};

/// Counts the traversal steps in `words`: the words of one walk, or of several walks one after the other.
inline WalkSteps count_steps(std::span<const std::uint32_t> words) {
  WalkSteps steps;
  for (std::size_t i = 0; i < words.size(); ++i) {
    if (kind_of(words[i]) == StepKind::kVisit) {
      steps.visits += 1;
      if (is_wide(words[i])) ++i;  // skips the word of hits
    } else if (is_enter(words[i])) {
      steps.enters += 1;
    } else if (kind_of(words[i]) == StepKind::kLeaf) {
      steps.tests += count_of(words[i++]);  // skips the word of exit phases
    }
  }
  return steps;
}

}  // namespace traces
