#pragma once
#include <limits>

#include "traces/accel/memory_image.h"
#include "traces/ray.h"

namespace traces {

/// How sure double precision is of a hit. kUncertain: within 1e-5 (barycentric) or 1e-6 of the scene's diagonal of an
/// edge, or within 1e-5 (and 1e-6 of the diagonal) of an end of the ray; single precision may decide either way.
enum class Standing { kMiss, kUncertain, kHit };

struct ExactHit {
  Standing standing = Standing::kMiss;
  double t = std::numeric_limits<double>::infinity();
};

/// Test of the triangle and, in two levels, the instance that `hit` names, which are there.
ExactHit exact_hit(const Ray& ray, const MemoryImage& image, const Hit& hit);

/// Triangles that must and that may be hit, from testing all triangles of the scene. In two levels instances that the
/// ray passes at some distance are left out.
struct ExactTrace {
  double nearest = std::numeric_limits<double>::infinity();  ///< distance of the nearest sure hit
  bool any_possible = false;                                 ///< some hit is sure or uncertain
};

ExactTrace exact_trace(const Ray& ray, const MemoryImage& image);

}  // namespace traces
