#pragma once
#include <cstdint>

#include "sim/error.h"
#include "traces/trace_file/tree_links.h"

// Bit encoding of walks (walk_code.h), shared by encoder and decoder.

namespace traces {

enum Pop : std::uint32_t { kNext = 0, kCullAll = 1, kEndHere = 2, kCullSome = 3 };

/// Converts exit phases of 4 bits each to 2 bits each; spread() does the reverse.
constexpr std::uint32_t squeeze(std::uint32_t x) {
  x &= 0x33333333U;
  x = (x | x >> 2) & 0x0f0f0f0fU;
  x = (x | x >> 4) & 0x00ff00ffU;
  return (x | x >> 8) & 0x0000ffffU;
}
constexpr std::uint32_t spread(std::uint32_t x) {
  x = (x | x << 8) & 0x00ff00ffU;
  x = (x | x << 4) & 0x0f0f0f0fU;
  return (x | x << 2) & 0x33333333U;
}

/// Returns the lowest bit of each nibble that is not 0.
constexpr std::uint32_t nonzero(std::uint32_t phases) {
  phases |= phases >> 1;
  return (phases | phases >> 2) & 0x11111111U;
}

/// True if exactly the first `tested` triangles of a leaf have an exit phase, and `tested` is not 0.
constexpr bool are_tested(std::uint32_t phases, std::uint32_t tested) {
  return tested != 0 && nonzero(phases) == (0x11111111U & (0xffffffffU >> (32 - 4 * tested)));
}

/// Bits of a cull count; a stack has kMaxTreeDepth entries per level.
inline constexpr std::uint32_t kCullBits = 7;
static_assert(kMaxTreeDepth == 1U << kCullBits);
constexpr std::uint32_t cull_bits(bool levels) { return kCullBits + (levels ? 1 : 0); }
inline constexpr std::size_t kStackSize = 2 * std::size_t{kMaxTreeDepth} + 1;

[[noreturn]] inline void no_walk() { throw sim::InputError("a ray's walk is none on this tree"); }

}  // namespace traces
