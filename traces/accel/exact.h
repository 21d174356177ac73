#pragma once
#include <limits>

#include "traces/accel/memory_image.h"
#include "traces/ray.h"

namespace traces {

/// Certainty of a hit in double precision. kUncertain: the hit is within 1e-5 (barycentric) or 1e-6 of the scene's
/// diagonal of an edge, or within 1e-5 (and 1e-6 of the diagonal) of an end of the ray. Single precision may then
/// decide either way.
enum class Standing { kMiss, kUncertain, kHit };

struct ExactHit {
  Standing standing = Standing::kMiss;
  double t = std::numeric_limits<double>::infinity();
};

/// Tests the ray against the triangle and instance named by `hit`, which must exist.
ExactHit exact_hit(const Ray& ray, const MemoryImage& image, const Hit& hit);

/// Result of testing a ray against all triangles of the scene. In two levels, instances far from the ray are skipped.
struct ExactTrace {
  double nearest = std::numeric_limits<double>::infinity();  ///< distance of the nearest certain hit
  bool any_possible = false;                                 ///< some hit is certain or uncertain
};

ExactTrace exact_trace(const Ray& ray, const MemoryImage& image);

}  // namespace traces
