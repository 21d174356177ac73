#pragma once
#include <cstddef>
#include <cstdint>
#include <cstring>

namespace sim {

/// Values are compared in groups of eight: two AVX2 vectors where available.
inline constexpr std::size_t kEight = 8;

/// Returns a mask with a bit for each of eight values that equals `number`.
#if defined(__AVX2__)  // vector extensions of the compiler: <immintrin.h> is longer than most files including this one
inline unsigned equal_of_eight(const std::uint64_t* eight, std::uint64_t number) {
  using Four [[gnu::vector_size(32)]] = std::uint64_t;
  using Doubles [[gnu::vector_size(32)]] = double;
  unsigned mask = 0;
  for (std::size_t i = 0; i < kEight; i += 4) {
    Four four;
    std::memcpy(&four, eight + i, sizeof four);
    mask |= static_cast<unsigned>(__builtin_ia32_movmskpd256(reinterpret_cast<Doubles>(four == number))) << i;
  }
  return mask;
}
#else
inline unsigned equal_of_eight(const std::uint64_t* eight, std::uint64_t number) {
  unsigned mask = 0;
  for (std::size_t i = 0; i < kEight; ++i) mask |= unsigned{eight[i] == number} << i;
  return mask;
}
#endif

}  // namespace sim
