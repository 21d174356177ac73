#pragma once
#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#if defined(__SSE4_2__)
#include <nmmintrin.h>
#endif

#include "sim/time.h"

namespace sim {

// The engine's wake array: for each unit the next time at which it has something to do. Units are few and all of them
// are looked at in every step, two at once where the host can.

/// The earliest of the times; kNever if there is none.
inline Time earliest(std::span<const Time> wakes) {
  std::size_t i = 0;
  Time first = kNever;
#if defined(__SSE4_2__)
  static_assert(kNever <= 0x7fffffffffffffffU, "compared as signed numbers");
  const __m128i never = _mm_set1_epi64x(static_cast<std::int64_t>(kNever));
  __m128i a = never, b = never;
  const auto lower = [](__m128i x, __m128i y) { return _mm_blendv_epi8(x, y, _mm_cmpgt_epi64(x, y)); };
  const auto at = [&](std::size_t k) { return _mm_loadu_si128(reinterpret_cast<const __m128i*>(&wakes[k])); };
  for (; i + 4 <= wakes.size(); i += 4) {
    a = lower(a, at(i));
    b = lower(b, at(i + 2));
  }
  a = lower(a, b);
  first = static_cast<Time>(std::min(_mm_cvtsi128_si64(a), _mm_extract_epi64(a, 1)));
#endif
  for (; i < wakes.size(); ++i) first = std::min(first, wakes[i]);
  return first;
}

/// A set of units, by their place in the wake array.
class UnitSet {
 public:
  explicit UnitSet(std::size_t units) : words_((units + 63) / 64) {}

  bool has(std::size_t unit) const { return ((words_[unit / 64] >> (unit % 64)) & 1U) != 0; }

  /// All that wake at `now`, the earliest time of all.
  void set_due(std::span<const Time> wakes, Time now) {
    for (std::size_t w = 0; w < words_.size(); ++w) {
      const std::size_t begin = w * 64, end = std::min(begin + 64, wakes.size());
      std::uint64_t word = 0;
      std::size_t i = begin;
#if defined(__SSE4_2__)
      const __m128i at_now = _mm_set1_epi64x(static_cast<std::int64_t>(now));
      for (; i + 2 <= end; i += 2) {
        const __m128i two = _mm_loadu_si128(reinterpret_cast<const __m128i*>(&wakes[i]));
        const int equal = _mm_movemask_pd(_mm_castsi128_pd(_mm_cmpeq_epi64(two, at_now)));
        word |= static_cast<std::uint64_t>(equal) << (i - begin);
      }
#endif
      for (; i < end; ++i) word |= std::uint64_t{wakes[i] == now} << (i - begin);
      words_[w] = word;
    }
  }

  /// Calls f(unit) for each, in order.
  template <class F>
  void each(F&& f) const {
    for (std::size_t w = 0; w < words_.size(); ++w) {
      for (std::uint64_t left = words_[w]; left != 0; left &= left - 1) {
        f(w * 64 + static_cast<std::size_t>(std::countr_zero(left)));
      }
    }
  }

 private:
  std::vector<std::uint64_t> words_;
};

}  // namespace sim
