#pragma once
#include <vector>

#include "traces/accel/memory_image.h"

namespace traces {

/// All triangles of a scene in world space, instance by instance; both arrays have the same index.
struct FlatTriangles {
  std::vector<TriangleRecord> triangles;
  std::vector<AttributeRecord> attributes;
};

FlatTriangles flatten(const Scene& scene);

}  // namespace traces
