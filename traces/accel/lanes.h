#pragma once
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>

#if defined(__SSE4_1__)
#include <smmintrin.h>
#endif

namespace traces {

// Vectors of four floats, in plain C++ and in an SSE register. Both round every operation equally, so code written on
// top of them gives the same bits. A comparison returns one bit per lane.

/// Four floats in plain C++.
struct PortableLanes {
  std::array<float, 4> v;

  static PortableLanes all(float x) { return {{x, x, x, x}}; }
  static PortableLanes of(float a, float b, float c, float d) { return {{a, b, c, d}}; }
  static PortableLanes load(const float* p) { return {{p[0], p[1], p[2], p[3]}}; }
  void store(float* p) const { std::copy_n(v.data(), 4, p); }

  /// Argument of swapped(): exchanges the lower and upper pair of lanes if true.
  struct Swap {
    bool on;
    explicit Swap(bool swap) : on(swap) {}
  };
  PortableLanes swapped(Swap s) const { return s.on ? of(v[2], v[3], v[0], v[1]) : *this; }
  float lane0() const { return v[0]; }
  float lane1() const { return v[1]; }
  PortableLanes upper_pair() const { return of(v[2], v[3], v[2], v[3]); }

  static PortableLanes each(const PortableLanes& a, const PortableLanes& b, auto&& f) {
    return of(f(a.v[0], b.v[0]), f(a.v[1], b.v[1]), f(a.v[2], b.v[2]), f(a.v[3], b.v[3]));
  }
  static unsigned bits(const PortableLanes& a, const PortableLanes& b, auto&& f) {
    unsigned mask = 0;
    for (unsigned i = 0; i < 4; ++i) mask |= f(a.v[i], b.v[i]) ? 1U << i : 0U;
    return mask;
  }
  friend PortableLanes operator+(const PortableLanes& a, const PortableLanes& b) {
    return each(a, b, [](float x, float y) { return x + y; });
  }
  friend PortableLanes operator-(const PortableLanes& a, const PortableLanes& b) {
    return each(a, b, [](float x, float y) { return x - y; });
  }
  friend PortableLanes operator*(const PortableLanes& a, const PortableLanes& b) {
    return each(a, b, [](float x, float y) { return x * y; });
  }
  friend PortableLanes operator/(const PortableLanes& a, const PortableLanes& b) {
    return each(a, b, [](float x, float y) { return x / y; });
  }
  friend PortableLanes operator-(const PortableLanes& a) { return of(-a.v[0], -a.v[1], -a.v[2], -a.v[3]); }
  friend PortableLanes min(const PortableLanes& a, const PortableLanes& b) {
    return each(a, b, [](float x, float y) { return x < y ? x : y; });
  }
  friend PortableLanes max(const PortableLanes& a, const PortableLanes& b) {
    return each(a, b, [](float x, float y) { return x > y ? x : y; });
  }
  friend PortableLanes abs(const PortableLanes& a) {
    return of(std::fabs(a.v[0]), std::fabs(a.v[1]), std::fabs(a.v[2]), std::fabs(a.v[3]));
  }
  friend unsigned less(const PortableLanes& a, const PortableLanes& b) {
    return bits(a, b, [](float x, float y) { return x < y; });
  }
  friend unsigned less_equal(const PortableLanes& a, const PortableLanes& b) {
    return bits(a, b, [](float x, float y) { return x <= y; });
  }
  friend unsigned equal(const PortableLanes& a, const PortableLanes& b) {
    return bits(a, b, [](float x, float y) { return x == y; });
  }
  /// Returns, lane by lane, `a < b ? yes : no`.
  friend PortableLanes if_less(const PortableLanes& a, const PortableLanes& b, const PortableLanes& yes,
                               const PortableLanes& no) {
    PortableLanes r = no;
    for (unsigned i = 0; i < 4; ++i) {
      if (a.v[i] < b.v[i]) r.v[i] = yes.v[i];
    }
    return r;
  }
  /// Transposes the 4 x 4 matrix whose rows are the arguments.
  static void transpose(PortableLanes& a, PortableLanes& b, PortableLanes& c, PortableLanes& d) {
    const std::array rows{a.v, b.v, c.v, d.v};
    for (unsigned i = 0; i < 4; ++i) {
      a.v[i] = rows[i][0];
      b.v[i] = rows[i][1];
      c.v[i] = rows[i][2];
      d.v[i] = rows[i][3];
    }
  }
};

#if defined(__SSE4_1__)

/// Four floats in an SSE register.
struct SseLanes {
  __m128 v;

  static SseLanes all(float x) { return {_mm_set1_ps(x)}; }
  static SseLanes of(float a, float b, float c, float d) { return {_mm_setr_ps(a, b, c, d)}; }
  static SseLanes load(const float* p) { return {_mm_loadu_ps(p)}; }
  void store(float* p) const { _mm_storeu_ps(p, v); }

  struct Swap {
    __m128i order;
    explicit Swap(bool swap)
        : order(swap ? _mm_setr_epi8(8, 9, 10, 11, 12, 13, 14, 15, 0, 1, 2, 3, 4, 5, 6, 7)
                     : _mm_setr_epi8(0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15)) {}
  };
  SseLanes swapped(const Swap& s) const { return {_mm_castsi128_ps(_mm_shuffle_epi8(_mm_castps_si128(v), s.order))}; }
  float lane0() const { return _mm_cvtss_f32(v); }
  float lane1() const { return _mm_cvtss_f32(_mm_movehdup_ps(v)); }
  SseLanes upper_pair() const { return {_mm_movehl_ps(v, v)}; }

  friend SseLanes operator+(SseLanes a, SseLanes b) { return {_mm_add_ps(a.v, b.v)}; }
  friend SseLanes operator-(SseLanes a, SseLanes b) { return {_mm_sub_ps(a.v, b.v)}; }
  friend SseLanes operator*(SseLanes a, SseLanes b) { return {_mm_mul_ps(a.v, b.v)}; }
  friend SseLanes operator/(SseLanes a, SseLanes b) { return {_mm_div_ps(a.v, b.v)}; }
  friend SseLanes operator-(SseLanes a) { return {_mm_xor_ps(a.v, _mm_set1_ps(-0.0F))}; }
  friend SseLanes min(SseLanes a, SseLanes b) { return {_mm_min_ps(a.v, b.v)}; }
  friend SseLanes max(SseLanes a, SseLanes b) { return {_mm_max_ps(a.v, b.v)}; }
  friend SseLanes abs(SseLanes a) { return {_mm_andnot_ps(_mm_set1_ps(-0.0F), a.v)}; }
  static unsigned bits(__m128 m) { return static_cast<unsigned>(_mm_movemask_ps(m)); }
  friend unsigned less(SseLanes a, SseLanes b) { return bits(_mm_cmplt_ps(a.v, b.v)); }
  friend unsigned less_equal(SseLanes a, SseLanes b) { return bits(_mm_cmple_ps(a.v, b.v)); }
  friend unsigned equal(SseLanes a, SseLanes b) { return bits(_mm_cmpeq_ps(a.v, b.v)); }
  friend SseLanes if_less(SseLanes a, SseLanes b, SseLanes yes, SseLanes no) {
    return {_mm_blendv_ps(no.v, yes.v, _mm_cmplt_ps(a.v, b.v))};
  }
  static void transpose(SseLanes& a, SseLanes& b, SseLanes& c, SseLanes& d) { _MM_TRANSPOSE4_PS(a.v, b.v, c.v, d.v); }
};
using NativeLanes = SseLanes;

#else
using NativeLanes = PortableLanes;
#endif

}  // namespace traces
