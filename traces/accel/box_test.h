#pragma once
#include <algorithm>
#include <cmath>
#include <limits>

#include "traces/accel/memory_image.h"
#include "traces/ray.h"

namespace traces {

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
  /// Prepares a ray for boxes in floats, in a scene with these bounds.
  RayBoxes(const Ray& ray, const glm::vec3& scene_lower, const glm::vec3& scene_upper)
      : RayBoxes(ray, reach(ray.origin, scene_lower, scene_upper)) {}
  /// Prepares a ray for boxes on a grid.
  RayBoxes(const Ray& ray, const glm::vec3& scene_lower, const glm::vec3& scene_upper, const BoxGrid& grid)
      : RayBoxes(ray, reach(ray.origin, scene_lower, scene_upper), grid) {}

  /// Returns in lanes 0 and 1 the distances at which the ray enters the two boxes, at least t_min. A box's bit in
  /// `hits` is set if the ray enters it before leaving it and before `limit`.
  Lanes enter(const NodeRecord& node, Lanes limit, unsigned& hits) const {
    const Lanes x = (Lanes::load(node.x).swapped(swap_x_) - x_) * inverse_x_;
    const Lanes y = (Lanes::load(node.y).swapped(swap_y_) - y_) * inverse_y_;
    const Lanes z = (Lanes::load(node.z).swapped(swap_z_) - z_) * inverse_z_;
    const Lanes span = max(max(x, y), max(z, limit));  // {enter 0, enter 1, -leave 0, -leave 1}
    hits = less_equal(span, -span.upper_pair()) & 3U;
    return span;
  }
  /// Returns the `limit` argument of enter() for the range t_min to t_max.
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

  /// Returns the largest distance along any axis from the origin to the scene's bounds. Rounding errors grow with it.
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
  /// Returns the reciprocal in grid steps, limited to that of `kTiny`.
  static float inverse(float d, float step) { return std::clamp(step * inverse(d), -1 / kTiny, 1 / kTiny); }
  static Lanes both_ways(float inverse) { return Lanes::of(inverse, inverse, -inverse, -inverse); }

  typename Lanes::Swap swap_x_, swap_y_, swap_z_;
  Lanes x_, y_, z_;
  Lanes inverse_x_, inverse_y_, inverse_z_;
};

}  // namespace traces
