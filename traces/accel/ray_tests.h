#pragma once
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <type_traits>

#include "traces/accel/memory_image.h"
#include "traces/ray.h"

#if defined(__SSE4_1__)
#include <immintrin.h>
#endif

namespace traces {

// Vectors of four floats, once in plain C++ and once in an SSE register. Both round every operation equally, so code
// that uses them gives the same bits. A comparison returns one bit per lane.

/// A vector of four floats in plain C++.
struct PortableLanes {
  static constexpr std::uint32_t kLanes = 4;
  std::array<float, 4> v;

  static PortableLanes from_float(float x) { return {{x, x, x, x}}; }
  static PortableLanes from_floats(float a, float b, float c, float d) { return {{a, b, c, d}}; }
  static PortableLanes load(const float* p) { return {{p[0], p[1], p[2], p[3]}}; }
  void store(float* p) const { std::copy_n(v.data(), 4, p); }

  /// Argument of swap_pairs(): if `on`, the lower and upper pairs of lanes are exchanged.
  struct Swap {
    bool on;
    explicit Swap(bool swap) : on(swap) {}
  };
  PortableLanes swap_pairs(Swap s) const { return s.on ? from_floats(v[2], v[3], v[0], v[1]) : *this; }
  float lane_0() const { return v[0]; }
  float lane_1() const { return v[1]; }
  PortableLanes upper_pair() const { return from_floats(v[2], v[3], v[2], v[3]); }

  static PortableLanes map_lanes(const PortableLanes& a, const PortableLanes& b, auto&& f) {
    return from_floats(f(a.v[0], b.v[0]), f(a.v[1], b.v[1]), f(a.v[2], b.v[2]), f(a.v[3], b.v[3]));
  }
  static unsigned lane_mask(const PortableLanes& a, const PortableLanes& b, auto&& f) {
    unsigned mask = 0;
    for (unsigned i = 0; i < 4; ++i) mask |= f(a.v[i], b.v[i]) ? 1U << i : 0U;
    return mask;
  }
  friend PortableLanes operator+(const PortableLanes& a, const PortableLanes& b) {
    return map_lanes(a, b, [](float x, float y) { return x + y; });
  }
  friend PortableLanes operator-(const PortableLanes& a, const PortableLanes& b) {
    return map_lanes(a, b, [](float x, float y) { return x - y; });
  }
  friend PortableLanes operator*(const PortableLanes& a, const PortableLanes& b) {
    return map_lanes(a, b, [](float x, float y) { return x * y; });
  }
  friend PortableLanes operator/(const PortableLanes& a, const PortableLanes& b) {
    return map_lanes(a, b, [](float x, float y) { return x / y; });
  }
  friend PortableLanes operator-(const PortableLanes& a) { return from_floats(-a.v[0], -a.v[1], -a.v[2], -a.v[3]); }
  friend PortableLanes min(const PortableLanes& a, const PortableLanes& b) {
    return map_lanes(a, b, [](float x, float y) { return x < y ? x : y; });
  }
  friend PortableLanes max(const PortableLanes& a, const PortableLanes& b) {
    return map_lanes(a, b, [](float x, float y) { return x > y ? x : y; });
  }
  friend PortableLanes abs(const PortableLanes& a) {
    return from_floats(std::fabs(a.v[0]), std::fabs(a.v[1]), std::fabs(a.v[2]), std::fabs(a.v[3]));
  }
  friend unsigned less_mask(const PortableLanes& a, const PortableLanes& b) {
    return lane_mask(a, b, [](float x, float y) { return x < y; });
  }
  friend unsigned less_equal_mask(const PortableLanes& a, const PortableLanes& b) {
    return lane_mask(a, b, [](float x, float y) { return x <= y; });
  }
  friend unsigned equal_mask(const PortableLanes& a, const PortableLanes& b) {
    return lane_mask(a, b, [](float x, float y) { return x == y; });
  }
  /// Returns in each lane `a < b ? yes : no`.
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

/// A vector of four floats in an SSE register.
struct SseLanes {
  static constexpr std::uint32_t kLanes = 4;
  __m128 v;

  static SseLanes from_float(float x) { return {_mm_set1_ps(x)}; }
  static SseLanes from_floats(float a, float b, float c, float d) { return {_mm_setr_ps(a, b, c, d)}; }
  static SseLanes load(const float* p) { return {_mm_loadu_ps(p)}; }
  void store(float* p) const { _mm_storeu_ps(p, v); }

  struct Swap {
    __m128i order;
    explicit Swap(bool swap)
        : order(swap ? _mm_setr_epi8(8, 9, 10, 11, 12, 13, 14, 15, 0, 1, 2, 3, 4, 5, 6, 7)
                     : _mm_setr_epi8(0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15)) {}
  };
  SseLanes swap_pairs(const Swap& s) const {
    return {_mm_castsi128_ps(_mm_shuffle_epi8(_mm_castps_si128(v), s.order))};
  }
  float lane_0() const { return _mm_cvtss_f32(v); }
  float lane_1() const { return _mm_cvtss_f32(_mm_movehdup_ps(v)); }
  SseLanes upper_pair() const { return {_mm_movehl_ps(v, v)}; }

  friend SseLanes operator+(SseLanes a, SseLanes b) { return {_mm_add_ps(a.v, b.v)}; }
  friend SseLanes operator-(SseLanes a, SseLanes b) { return {_mm_sub_ps(a.v, b.v)}; }
  friend SseLanes operator*(SseLanes a, SseLanes b) { return {_mm_mul_ps(a.v, b.v)}; }
  friend SseLanes operator/(SseLanes a, SseLanes b) { return {_mm_div_ps(a.v, b.v)}; }
  friend SseLanes operator-(SseLanes a) { return {_mm_xor_ps(a.v, _mm_set1_ps(-0.0F))}; }
  friend SseLanes min(SseLanes a, SseLanes b) { return {_mm_min_ps(a.v, b.v)}; }
  friend SseLanes max(SseLanes a, SseLanes b) { return {_mm_max_ps(a.v, b.v)}; }
  friend SseLanes abs(SseLanes a) { return {_mm_andnot_ps(_mm_set1_ps(-0.0F), a.v)}; }
  static unsigned lane_mask(__m128 m) { return static_cast<unsigned>(_mm_movemask_ps(m)); }
  friend unsigned less_mask(SseLanes a, SseLanes b) { return lane_mask(_mm_cmplt_ps(a.v, b.v)); }
  friend unsigned less_equal_mask(SseLanes a, SseLanes b) { return lane_mask(_mm_cmple_ps(a.v, b.v)); }
  friend unsigned equal_mask(SseLanes a, SseLanes b) { return lane_mask(_mm_cmpeq_ps(a.v, b.v)); }
  friend SseLanes if_less(SseLanes a, SseLanes b, SseLanes yes, SseLanes no) {
    return {_mm_blendv_ps(no.v, yes.v, _mm_cmplt_ps(a.v, b.v))};
  }
  static void transpose(SseLanes& a, SseLanes& b, SseLanes& c, SseLanes& d) { _MM_TRANSPOSE4_PS(a.v, b.v, c.v, d.v); }
};
using NativeLanes = SseLanes;

#else
using NativeLanes = PortableLanes;
#endif

#if defined(__AVX__)

/// A vector of eight floats in an AVX register, with the operations of box tests.
struct AvxLanes {
  static constexpr std::uint32_t kLanes = 8;
  __m256 v;

  static AvxLanes from_float(float x) { return {_mm256_set1_ps(x)}; }
  static AvxLanes load(const float* p) { return {_mm256_loadu_ps(p)}; }
  void store(float* p) const { _mm256_storeu_ps(p, v); }
  friend AvxLanes operator-(AvxLanes a, AvxLanes b) { return {_mm256_sub_ps(a.v, b.v)}; }
  friend AvxLanes operator*(AvxLanes a, AvxLanes b) { return {_mm256_mul_ps(a.v, b.v)}; }
  friend AvxLanes min(AvxLanes a, AvxLanes b) { return {_mm256_min_ps(a.v, b.v)}; }
  friend AvxLanes max(AvxLanes a, AvxLanes b) { return {_mm256_max_ps(a.v, b.v)}; }
  friend unsigned less_equal_mask(AvxLanes a, AvxLanes b) {
    return static_cast<unsigned>(_mm256_movemask_ps(_mm256_cmp_ps(a.v, b.v, _CMP_LE_OQ)));
  }
};

/// The vector that tests `kSlots` boxes of a wide node: eight at once where the host can.
template <class Lanes, std::uint32_t kSlots>
using BoxLanes = std::conditional_t<std::is_same_v<Lanes, NativeLanes> && kSlots == AvxLanes::kLanes, AvxLanes, Lanes>;

#else
template <class Lanes, std::uint32_t>
using BoxLanes = Lanes;
#endif

/// How a ray is prepared for box tests, per axis. RayBoxes has the rules.
class BoxRay {
 public:
  struct Axis {
    float ahead, back;  ///< the origin moved forward and back
    float inverse;      ///< reciprocal of the direction
    bool is_negative;
  };

  /// Prepares a ray for boxes in floats. The scene bounds determine the rounding margin.
  BoxRay(const Ray& ray, const glm::vec3& scene_lower, const glm::vec3& scene_upper) {
    const float reach = scene_reach(ray.origin, scene_lower, scene_upper);
    for (int a = 0; a < 3; ++a) {
      const float o = ray.origin[a];
      const float pad = kEpsilon * (8 * reach + std::fabs(o));
      axes_[a] = axis_of(ray, a, o - pad, o + pad, safe_reciprocal(ray.direction[a]));
    }
  }
  /// Prepares a ray for boxes in hybrid numbers on `grid`.
  BoxRay(const Ray& ray, const glm::vec3& scene_lower, const glm::vec3& scene_upper, const BoxGrid& grid) {
    const float reach = scene_reach(ray.origin, scene_lower, scene_upper);
    for (int a = 0; a < 3; ++a) {
      const float o = ray.origin[a];
      const float pad = kEpsilon * (10 * reach + std::fabs(o));
      const auto planes = [&](float x) { return (x - grid.lower_corner()[a]) / grid.plane_spacing()[a]; };
      axes_[a] = axis_of(ray, a, std::floor(planes(o - pad)), std::ceil(planes(o + pad)),
                         safe_reciprocal(ray.direction[a], grid.plane_spacing()[a]));
    }
  }
  const Axis& operator[](int axis) const { return axes_[axis]; }

 private:
  static constexpr float kEpsilon = std::numeric_limits<float>::epsilon();
  static constexpr float kTiny = 1e-30F;

  /// Returns the largest distance along any axis from the ray's origin to the scene's bounds. Rounding errors are
  /// proportional to it.
  static float scene_reach(const glm::vec3& o, const glm::vec3& lower, const glm::vec3& upper) {
    float r = 0;
    for (int a = 0; a < 3; ++a) r = std::max({r, std::fabs(o[a] - lower[a]), std::fabs(o[a] - upper[a])});
    return r;
  }
  static Axis axis_of(const Ray& ray, int axis, float below, float above, float inverse) {
    const bool negative = ray.direction[axis] < 0;
    return {negative ? below : above, negative ? above : below, inverse, negative};
  }
  static float safe_reciprocal(float d) { return 1 / (std::fabs(d) < kTiny ? (d < 0 ? -kTiny : kTiny) : d); }
  /// Returns the reciprocal of direction component `d` in grid steps, limited to the reciprocal of kTiny.
  static float safe_reciprocal(float d, float step) {
    return std::clamp(step * safe_reciprocal(d), -1 / kTiny, 1 / kTiny);
  }

  Axis axes_[3];
};

/// A ray prepared for testing both boxes of a node at once.
///
/// 1. The test is conservative: it never misses a box that contains a triangle hit. Near planes are measured from an
///    origin moved forward, far planes from one moved back, each by the rounding error of the box and triangle tests
///    (Woop, Benthin, Wald 2013: "Watertight Ray/Triangle Intersection"). A ray that slides along a face is therefore
///    inside the box.
/// 2. A zero direction component is replaced by a tiny one, so that infinity is never multiplied by zero.
/// 3. In hybrid numbers (US patent 9,830,733) planes and both origins are whole grid steps. Their difference is exact;
///    only the reciprocal of the direction, in steps, is a float.
/// 4. Hybrid numbers are conservative too. Planes are rounded outward from floats, and the moved origins are rounded
///    outward to whole steps. Converting the origin to the grid rounds twice and the reciprocal rounds once more, each
///    by at most half an epsilon of the reach, so two epsilons are added to the displacement of the origins. Beyond
///    2^24 steps the difference is rounded as between floats, which the displacement already covers.
template <class Lanes>
class RayBoxes {
 public:
  explicit RayBoxes(const BoxRay& ray)
      : swap_x_(ray[0].is_negative),
        swap_y_(ray[1].is_negative),
        swap_z_(ray[2].is_negative),
        x_(moved_origins(ray[0])),
        y_(moved_origins(ray[1])),
        z_(moved_origins(ray[2])),
        inverse_x_(signed_lanes(ray[0].inverse)),
        inverse_y_(signed_lanes(ray[1].inverse)),
        inverse_z_(signed_lanes(ray[2].inverse)) {}

  /// Returns in lanes 0 and 1 the distances at which the ray enters the two boxes of a node, at least t_min. Bit i of
  /// `hits` is set if the ray enters box i before it leaves it and before `limit`.
  Lanes entry_distances(const NodeRecord& node, Lanes limit, unsigned& hits) const {
    const Lanes x = (Lanes::load(node.x).swap_pairs(swap_x_) - x_) * inverse_x_;
    const Lanes y = (Lanes::load(node.y).swap_pairs(swap_y_) - y_) * inverse_y_;
    const Lanes z = (Lanes::load(node.z).swap_pairs(swap_z_) - z_) * inverse_z_;
    const Lanes span = max(max(x, y), max(z, limit));  // {enter 0, enter 1, -leave 0, -leave 1}
    hits = less_equal_mask(span, -span.upper_pair()) & 3U;
    return span;
  }
  /// Returns the `limit` argument of entry_distances() for a ray from t_min to t_max.
  static Lanes distance_limits(float t_min, float t_max) { return Lanes::from_floats(t_min, t_min, -t_max, -t_max); }

 private:
  static Lanes moved_origins(const BoxRay::Axis& axis) {
    return Lanes::from_floats(axis.ahead, axis.ahead, axis.back, axis.back);
  }
  static Lanes signed_lanes(float inverse) { return Lanes::from_floats(inverse, inverse, -inverse, -inverse); }

  typename Lanes::Swap swap_x_, swap_y_, swap_z_;
  Lanes x_, y_, z_;
  Lanes inverse_x_, inverse_y_, inverse_z_;
};

/// A ray prepared for testing the boxes of all children of a wide node, a vector of them at a time. The arithmetic of a
/// box is that of RayBoxes, so a box gives the same answer and distance in trees of any width.
template <class Lanes>
class RayWideBoxes {
 public:
  explicit RayWideBoxes(const BoxRay& ray) {
    for (std::uint32_t a = 0; a < 3; ++a) {
      const BoxRay::Axis& axis = ray[static_cast<int>(a)];
      near_[a] = 2 * kMaxWidth * a + (axis.is_negative ? kMaxWidth : 0);
      far_[a] = 2 * kMaxWidth * a + (axis.is_negative ? 0 : kMaxWidth);
      ahead_[a] = Lanes::from_float(axis.ahead);
      back_[a] = Lanes::from_float(axis.back);
      inverse_[a] = Lanes::from_float(axis.inverse);
    }
  }

  /// Returns the octant of the ray's direction: bit a is set if it is positive along axis a.
  std::uint32_t octant() const {
    std::uint32_t positive = 0;
    for (std::uint32_t a = 0; a < 3; ++a) positive |= near_[a] < far_[a] ? 1U << a : 0U;
    return positive;
  }

  /// Writes to `enter` the distances at which the ray enters the boxes of slots [0, kSlots), at least t_min. Returns a
  /// bit for each slot whose box the ray enters before it leaves it and before `limit`.
  template <std::uint32_t kSlots>
  unsigned entry_distances(const WideNode& node, float t_min, float limit, float* enter) const {
    const float* planes = &node.planes[0][0][0];
    unsigned hits = 0;
    for (std::uint32_t slot = 0; slot < kSlots; slot += Lanes::kLanes) {
      const auto near = [&](int a) { return (Lanes::load(planes + near_[a] + slot) - ahead_[a]) * inverse_[a]; };
      const auto far = [&](int a) { return (Lanes::load(planes + far_[a] + slot) - back_[a]) * inverse_[a]; };
      const Lanes in = max(max(near(0), near(1)), max(near(2), Lanes::from_float(t_min)));
      const Lanes out = min(min(far(0), far(1)), min(far(2), Lanes::from_float(limit)));
      in.store(enter + slot);
      hits |= less_equal_mask(in, out) << slot;
    }
    return hits;
  }

 private:
  std::uint32_t near_[3], far_[3];  ///< where the near and far planes of each axis begin in a node
  Lanes ahead_[3], back_[3], inverse_[3];
};

/// A 3D vector in each of four SIMD lanes.
template <class Lanes>
struct Lanes3 {
  Lanes x, y, z;
  friend Lanes3 operator+(const Lanes3& a, const Lanes3& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
  friend Lanes3 operator-(const Lanes3& a, const Lanes3& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
  friend Lanes dot(const Lanes3& a, const Lanes3& b) { return a.x * b.x + (a.y * b.y + a.z * b.z); }
  friend Lanes3 cross(const Lanes3& a, const Lanes3& b) {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
  }
};

/// Tests one ray against up to four triangles at once.
///
/// 1. The edge tests are Pluecker products of vertices relative to the ray's origin. Triangles that share an edge
/// compute the same value with opposite sign, so no ray passes between them.
/// 2. Both faces are hit; Result::culled_mask() finds culled faces.
/// 3. A triangle without area, or a ray in the triangle's plane, gives no finite distance.
template <class Lanes>
class RayTriangles {
 public:
  explicit RayTriangles(const Ray& ray)
      : origin_{Lanes::from_float(ray.origin.x), Lanes::from_float(ray.origin.y), Lanes::from_float(ray.origin.z)},
        direction_{Lanes::from_float(ray.direction.x), Lanes::from_float(ray.direction.y),
                   Lanes::from_float(ray.direction.z)} {}

  struct Result {
    Lanes t;             ///< distance from the ray's origin to the plane of the triangle
    Lanes slope;         ///< negative if the ray sees the corners in counter-clockwise order
    Lanes u, v, w, sum;  ///< weights of the second, third and first vertex, multiplied by `sum`
    /// Returns a mask of the lanes whose triangle the ray passes through.
    unsigned inside_mask() const {
      const Lanes slack = Lanes::from_float(std::numeric_limits<float>::epsilon()) * abs(sum);
      const unsigned positive = less_equal_mask(-slack, min(min(u, v), w));
      const unsigned negative = less_equal_mask(max(max(u, v), w), slack);
      return (positive | negative) & ~equal_mask(sum, Lanes::from_float(0));
    }
    /// Returns a mask of those of the `count` triangles at `at` whose face on the ray's side is culled.
    unsigned culled_mask(const TriangleRecord* at, unsigned count) const {
      const unsigned clockwise = less_mask(Lanes::from_float(0), slope);
      unsigned lanes = 0;
      for (unsigned i = 0; i < count; ++i) {
        const bool is_clockwise = ((clockwise >> i) & 1U) != 0;
        lanes |= (at[i].material & (is_clockwise ? kNoClockwise : kNoCounterClockwise)) != 0 ? 1U << i : 0U;
      }
      return lanes;
    }
  };

  /// Tests the `count` triangles at `at` (1 to 4). Unused lanes repeat the last triangle.
  Result test_triangles(const TriangleRecord* at, unsigned count) const {
    Lanes rows[3][4];
    for (unsigned i = 0; i < 4; ++i) {
      const float* p = &at[i < count ? i : count - 1].v0.x;
      rows[0][i] = Lanes::load(p);
      rows[1][i] = Lanes::load(p + 4);
      rows[2][i] = Lanes::load(p + 8);
    }
    for (auto& r : rows) Lanes::transpose(r[0], r[1], r[2], r[3]);
    const Lanes3<Lanes> v0 = Lanes3<Lanes>{rows[0][0], rows[0][1], rows[0][2]} - origin_;
    const Lanes3<Lanes> v1 = Lanes3<Lanes>{rows[0][3], rows[1][0], rows[1][1]} - origin_;
    const Lanes3<Lanes> v2 = Lanes3<Lanes>{rows[1][2], rows[1][3], rows[2][0]} - origin_;
    const Lanes3<Lanes> e0 = v2 - v0, e1 = v0 - v1, e2 = v1 - v2;

    Result r;
    r.u = dot(cross(e0, v2 + v0), direction_);
    r.v = dot(cross(e1, v0 + v1), direction_);
    r.w = dot(cross(e2, v1 + v2), direction_);
    r.sum = r.u + r.v + r.w;
    const Lanes3<Lanes> n = plane_normal(e0, e1, e2);
    r.slope = dot(direction_, n);
    r.t = dot(v0, n) / r.slope;
    return r;
  }

 private:
  /// Returns the normal of a triangle's plane. Each component comes from the pair of edges with the smaller product,
  /// which rounds less.
  static Lanes3<Lanes> plane_normal(const Lanes3<Lanes>& a, const Lanes3<Lanes>& b, const Lanes3<Lanes>& c) {
    const auto better = [](Lanes ab0, Lanes ab1, Lanes bc0, Lanes bc1) {
      return if_less(abs(ab1), abs(bc1), ab0 - ab1, bc0 - bc1);
    };
    return {better(a.y * b.z, a.z * b.y, b.y * c.z, b.z * c.y), better(a.z * b.x, a.x * b.z, b.z * c.x, b.x * c.z),
            better(a.x * b.y, a.y * b.x, b.x * c.y, b.y * c.x)};
  }

  Lanes3<Lanes> origin_, direction_;
};

}  // namespace traces
