#pragma once
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>

namespace sim {

/// Number of values that match_mask8() compares at once, in two AVX2 vectors where available.
inline constexpr std::size_t kMatchWidth = 8;

/// Compares eight values with `number`. Returns a mask of those that are equal to it.
#if defined(__AVX2__)  // compiler vector extensions, because including <immintrin.h> would slow down compilation
inline unsigned match_mask8(const std::uint64_t* eight_numbers, std::uint64_t number) {
  using Four [[gnu::vector_size(32)]] = std::uint64_t;
  using Doubles [[gnu::vector_size(32)]] = double;
  unsigned mask = 0;
  for (std::size_t i = 0; i < kMatchWidth; i += 4) {
    Four four;
    std::memcpy(&four, eight_numbers + i, sizeof four);
    mask |= static_cast<unsigned>(__builtin_ia32_movmskpd256(reinterpret_cast<Doubles>(four == number))) << i;
  }
  return mask;
}
#else
inline unsigned match_mask8(const std::uint64_t* eight_numbers, std::uint64_t number) {
  unsigned mask = 0;
  for (std::size_t i = 0; i < kMatchWidth; ++i) mask |= unsigned{eight_numbers[i] == number} << i;
  return mask;
}
#endif

/// Returns the index of the smallest of `count` numbers, the first among equals. `count` must not be 0. Branch-free,
/// because the result is unpredictable.
inline std::uint32_t index_of_min(const std::uint32_t* numbers, std::size_t count) {
  std::uint64_t least = std::numeric_limits<std::uint64_t>::max();
  for (std::size_t i = 0; i < count; ++i) least = std::min(least, std::uint64_t{numbers[i]} << 32 | i);
  return static_cast<std::uint32_t>(least);
}

}  // namespace sim
