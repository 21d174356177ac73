#pragma once
#include <vector>

#include "traces/accel/material_tables.h"
#include "traces/accel/memory_image.h"

namespace traces {

/// All triangles of a scene in world space, instance by instance; the arrays have the same index.
struct FlatTriangles {
  std::vector<TriangleRecord> triangles;
  std::vector<AttributeRecord> attributes;
  std::vector<VertexRecord> vertices;  ///< empty if no material needs them
};

FlatTriangles flatten(const Scene& scene, const MaterialTables& materials);

}  // namespace traces
