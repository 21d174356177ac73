#pragma once
#include <algorithm>
#include <cmath>
#include <limits>

#include "traces/accel/memory_image.h"
#include "traces/ray.h"

namespace traces {

/// Ray prepared for testing the two boxes of a node at once.
///
/// Conservative: a box is never missed whose triangles the triangle test would hit. The near planes are seen from an
/// origin moved ahead and the far planes from one moved back by the rounding errors that either test can make (Woop,
/// Benthin, Wald 2013: "Watertight Ray/Triangle Intersection"), which also holds a ray inside a box it slides along.
/// A direction component of zero is taken as a tiny one, so that no infinity meets a zero.
///
/// Hybrid numbers (US patent 9,830,733): planes and both origins are whole steps of the image's grid, so that their
/// difference is exact, and only the reciprocal, of the direction in steps, is a float. This is conservative too.
/// Planes lie outside of those of floats, and the origins, moved as much as there, are rounded outward to a whole step.
/// Roundings besides: an origin's way to the grid, twice, and the reciprocal once more, each by half an epsilon
/// of the reach at most; so two epsilons are added to what origins are moved by. Over 2^24 steps away floats count no
/// longer every step; there the difference is rounded as that of floats is, which what origins are moved by covers
/// already.
template <class Lanes>
class RayBoxes {
 public:
  /// Boxes of floats in a scene of these bounds.
  RayBoxes(const Ray& ray, const glm::vec3& scene_lower, const glm::vec3& scene_upper)
      : RayBoxes(ray, reach(ray.origin, scene_lower, scene_upper)) {}
  /// Boxes that lie on a grid.
  RayBoxes(const Ray& ray, const glm::vec3& scene_lower, const glm::vec3& scene_upper, const BoxGrid& grid)
      : RayBoxes(ray, reach(ray.origin, scene_lower, scene_upper), grid) {}

  /// Distances at which the ray enters both boxes, not before t_min, in lanes 0 and 1; `hits` gets a bit per box that
  /// the ray enters no later than it leaves it or comes to `limit`.
  Lanes enter(const NodeRecord& node, Lanes limit, unsigned& hits) const {
    const Lanes x = (Lanes::load(node.x).swapped(swap_x_) - x_) * inverse_x_;
    const Lanes y = (Lanes::load(node.y).swapped(swap_y_) - y_) * inverse_y_;
    const Lanes z = (Lanes::load(node.z).swapped(swap_z_) - z_) * inverse_z_;
    const Lanes span = max(max(x, y), max(z, limit));  // {enter 0, enter 1, -leave 0, -leave 1}
    hits = less_equal(span, -span.upper_pair()) & 3U;
    return span;
  }
  /// The last argument of enter(): nothing before `t_min` or behind `t_max`.
  static Lanes limits(float t_min, float t_max) { return Lanes::of(t_min, t_min, -t_max, -t_max); }

 private:
  static constexpr float kEpsilon = std::numeric_limits<float>::epsilon();
  static constexpr float kTiny = 1e-30F;

  RayBoxes(const Ray& ray, float reach)
      : swap_x_(ray.direction.x < 0),
        swap_y_(ray.direction.y < 0),
        swap_z_(ray.direction.z < 0),
        x_(origin(ray, 0, reach)),
        y_(origin(ray, 1, reach)),
        z_(origin(ray, 2, reach)),
        inverse_x_(both_ways(inverse(ray.direction.x))),
        inverse_y_(both_ways(inverse(ray.direction.y))),
        inverse_z_(both_ways(inverse(ray.direction.z))) {}
  RayBoxes(const Ray& ray, float reach, const BoxGrid& grid)
      : swap_x_(ray.direction.x < 0),
        swap_y_(ray.direction.y < 0),
        swap_z_(ray.direction.z < 0),
        x_(origin(ray, 0, reach, grid)),
        y_(origin(ray, 1, reach, grid)),
        z_(origin(ray, 2, reach, grid)),
        inverse_x_(both_ways(inverse(ray.direction.x, grid.step().x))),
        inverse_y_(both_ways(inverse(ray.direction.y, grid.step().y))),
        inverse_z_(both_ways(inverse(ray.direction.z, grid.step().z))) {}

  /// How far the scene's farthest corner is along any axis: rounding errors of the tests grow with it.
  static float reach(const glm::vec3& o, const glm::vec3& lower, const glm::vec3& upper) {
    float r = 0;
    for (int a = 0; a < 3; ++a) r = std::max({r, std::fabs(o[a] - lower[a]), std::fabs(o[a] - upper[a])});
    return r;
  }
  static Lanes origin(const Ray& ray, int axis, float reach) {
    const float o = ray.origin[axis];
    const float pad = kEpsilon * (8 * reach + std::fabs(o));
    return ahead_and_back(ray, axis, o - pad, o + pad);
  }
  static Lanes origin(const Ray& ray, int axis, float reach, const BoxGrid& grid) {
    const float o = ray.origin[axis];
    const float pad = kEpsilon * (10 * reach + std::fabs(o));
    const auto planes = [&](float x) { return (x - grid.lower()[axis]) / grid.step()[axis]; };
    return ahead_and_back(ray, axis, std::floor(planes(o - pad)), std::ceil(planes(o + pad)));
  }
  static Lanes ahead_and_back(const Ray& ray, int axis, float below, float above) {
    const float ahead = ray.direction[axis] < 0 ? below : above;
    const float back = ray.direction[axis] < 0 ? above : below;
    return Lanes::of(ahead, ahead, back, back);
  }
  static float inverse(float d) { return 1 / (std::fabs(d) < kTiny ? (d < 0 ? -kTiny : kTiny) : d); }
  /// In steps; a direction that is tiny in steps is taken as `kTiny` too.
  static float inverse(float d, float step) { return std::clamp(step * inverse(d), -1 / kTiny, 1 / kTiny); }
  static Lanes both_ways(float inverse) { return Lanes::of(inverse, inverse, -inverse, -inverse); }

  typename Lanes::Swap swap_x_, swap_y_, swap_z_;
  Lanes x_, y_, z_;
  Lanes inverse_x_, inverse_y_, inverse_z_;
};

}  // namespace traces
