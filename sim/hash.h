#pragma once
#include <cstdint>

namespace sim {

/// Mixes the bits of a number: a bijective 64-bit finaliser with the variant 13 constants of D. Stafford, as in
/// SplitMix64.
constexpr std::uint64_t mix_bits(std::uint64_t x) {
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9ULL;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebULL;
  return x ^ (x >> 31);
}

/// Returns a random number that depends on the keys alone, such as hash(frame, pixel, sample, bounce, dimension).
template <class... Keys>
constexpr std::uint64_t hash(Keys... keys) {
  std::uint64_t h = 0x9e3779b97f4a7c15ULL;
  ((h = mix_bits(h ^ (static_cast<std::uint64_t>(keys) + 0x9e3779b97f4a7c15ULL + (h << 6)))), ...);
  return h;
}

/// Converts a hash to a float in [0, 1) with 24 random bits.
constexpr float unit_float(std::uint64_t hash_bits) { return static_cast<float>(hash_bits >> 40) * 0x1p-24F; }

}  // namespace sim
