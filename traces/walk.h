#pragma once
#include <cstdint>

namespace traces {

// The canonical walk of a ray: near child first, full stack, both boxes per visit. It is what happened, free of any
// stack scheme, cache or address; a machine expands it to its own mechanisms. One ray's walk is a run of 32-bit
// words that ends with kEnd:
//
//   visit  00 | near(1) | hits(2) | node(27)      inner node tested; bit 0 of `hits` is child 0, bit 1 child 1;
//                                                  `near` is the child entered first when both are hit
//   leaf   01 | count(4) | first triangle(26)      leaf entered, `count` triangles tested (a shadow ray stops behind
//                                                  a hit without flags, ray.h); one more word follows: the exit phase
//                                                  of each test, 4 bits each, first test lowest
//   enter  01 | 0(4) | instance(26)                the ray goes on in the space of an instance, at its tree's root
//   cull   10 | n(30)                              n stack entries popped and dropped: they begin behind the hit
//   end    11 | hit(1)
//
// A visit that hits nothing and a leaf are followed by a pop (or the end); a visit that hits both pushes the far child.
// An enter is followed by the visit of that root. There is no word for leaving: the ray is back in world space as soon
// as an entry comes off the stack that was there when it entered.

enum class StepKind : std::uint32_t { kVisit = 0, kLeaf = 1, kCull = 2, kEnd = 3 };

/// Where a triangle test stopped (a hit goes through all three phases).
enum class ExitPhase : std::uint32_t { kDistance = 1, kBarycentric = 2, kHit = 3 };

inline constexpr std::uint32_t kMaxNodes = 1U << 27;
inline constexpr std::uint32_t kMaxTriangles = 1U << 26;
inline constexpr std::uint32_t kMaxLeafTriangles = 8;

constexpr StepKind kind_of(std::uint32_t word) { return static_cast<StepKind>(word >> 30); }

constexpr std::uint32_t visit_step(std::uint32_t node, std::uint32_t hits, std::uint32_t near) {
  return (near << 29) | (hits << 27) | node;
}
constexpr std::uint32_t node_of(std::uint32_t word) { return word & (kMaxNodes - 1); }
constexpr std::uint32_t hits_of(std::uint32_t word) { return (word >> 27) & 3U; }
constexpr std::uint32_t near_of(std::uint32_t word) { return (word >> 29) & 1U; }

constexpr std::uint32_t leaf_step(std::uint32_t first, std::uint32_t count) {
  return (1U << 30) | (count << 26) | first;
}
constexpr std::uint32_t enter_step(std::uint32_t instance) { return leaf_step(instance, 0); }
constexpr bool is_enter(std::uint32_t word) { return word >> 26 == 1U << 4; }
constexpr std::uint32_t instance_of(std::uint32_t word) { return word & (kMaxTriangles - 1); }
constexpr std::uint32_t first_of(std::uint32_t word) { return word & (kMaxTriangles - 1); }
constexpr std::uint32_t count_of(std::uint32_t word) { return (word >> 26) & 15U; }
constexpr ExitPhase phase_of(std::uint32_t phases, std::uint32_t test) {
  return static_cast<ExitPhase>((phases >> (4 * test)) & 15U);
}

constexpr std::uint32_t cull_step(std::uint32_t n) { return (2U << 30) | n; }
constexpr std::uint32_t culled_of(std::uint32_t word) { return word & ((1U << 30) - 1); }

constexpr std::uint32_t end_step(bool hit) { return (3U << 30) | (hit ? 1U : 0U); }

}  // namespace traces
