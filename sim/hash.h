#pragma once
#include <cstdint>

namespace sim {

/// Hashes a number bijectively: the 64-bit finaliser of SplitMix64, with the variant 13 constants of D. Stafford.
constexpr std::uint64_t mix_bits(std::uint64_t x) {
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9ULL;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebULL;
  return x ^ (x >> 31);
}

/// Returns a pseudo-random number that depends only on the keys, such as hash(frame, pixel, sample, bounce, dimension).
template <class... Keys>
constexpr std::uint64_t hash(Keys... keys) {
  std::uint64_t h = 0x9e3779b97f4a7c15ULL;
  ((h = mix_bits(h ^ (static_cast<std::uint64_t>(keys) + 0x9e3779b97f4a7c15ULL + (h << 6)))), ...);
  return h;
}

/// Converts a hash to a float in [0, 1) with 24 random bits.
constexpr float hash_to_unit_float(std::uint64_t hash_bits) { return static_cast<float>(hash_bits >> 40) * 0x1p-24F; }

}  // namespace sim
