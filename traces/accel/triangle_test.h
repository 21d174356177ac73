#pragma once
#include <limits>

#include "traces/accel/memory_image.h"
#include "traces/ray.h"

namespace traces {

/// A 3D vector per lane.
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

/// Tests one ray against up to four triangles.
///
/// 1. The edge tests are Pluecker products of vertices relative to the ray's origin. Triangles that share an edge
///    compute the same value with opposite sign, so no ray passes between them.
/// 2. Both faces are hit; Result::missing() finds culled faces.
/// 3. A triangle without area, or a ray in the triangle's plane, gives no finite distance.
template <class Lanes>
class RayTriangles {
 public:
  explicit RayTriangles(const Ray& ray)
      : origin_{Lanes::all(ray.origin.x), Lanes::all(ray.origin.y), Lanes::all(ray.origin.z)},
        direction_{Lanes::all(ray.direction.x), Lanes::all(ray.direction.y), Lanes::all(ray.direction.z)} {}

  struct Result {
    Lanes t;             ///< distance of the triangle's plane
    Lanes slope;         ///< negative if the ray sees the corners in counter-clockwise order
    Lanes u, v, w, sum;  ///< weights of the second, third and first vertex, multiplied by `sum`
    /// Returns a bit per lane: the ray passes through the triangle.
    unsigned inside() const {
      const Lanes slack = Lanes::all(std::numeric_limits<float>::epsilon()) * abs(sum);
      const unsigned positive = less_equal(-slack, min(min(u, v), w));
      const unsigned negative = less_equal(max(max(u, v), w), slack);
      return (positive | negative) & ~equal(sum, Lanes::all(0));
    }
    /// Returns a bit for each of the `count` triangles at `at`: the face that the ray sees is culled.
    unsigned missing(const TriangleRecord* at, unsigned count) const {
      const unsigned clockwise = less(Lanes::all(0), slope);
      unsigned lanes = 0;
      for (unsigned i = 0; i < count; ++i) {
        const bool is_clockwise = ((clockwise >> i) & 1U) != 0;
        lanes |= (at[i].material & (is_clockwise ? kNoClockwise : kNoCounterClockwise)) != 0 ? 1U << i : 0U;
      }
      return lanes;
    }
  };

  /// Tests the `count` triangles at `at` (1 to 4); unused lanes repeat the last.
  Result test(const TriangleRecord* at, unsigned count) const {
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
    const Lanes3<Lanes> n = normal(e0, e1, e2);
    r.slope = dot(direction_, n);
    r.t = dot(v0, n) / r.slope;
    return r;
  }

 private:
  /// Returns the normal. Each component comes from the pair of edges with the smaller product, which rounds less.
  static Lanes3<Lanes> normal(const Lanes3<Lanes>& a, const Lanes3<Lanes>& b, const Lanes3<Lanes>& c) {
    const auto better = [](Lanes ab0, Lanes ab1, Lanes bc0, Lanes bc1) {
      return if_less(abs(ab1), abs(bc1), ab0 - ab1, bc0 - bc1);
    };
    return {better(a.y * b.z, a.z * b.y, b.y * c.z, b.z * c.y), better(a.z * b.x, a.x * b.z, b.z * c.x, b.x * c.z),
            better(a.x * b.y, a.y * b.x, b.x * c.y, b.y * c.x)};
  }

  Lanes3<Lanes> origin_, direction_;
};

}  // namespace traces
