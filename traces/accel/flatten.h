#pragma once
#include <vector>

#include "traces/accel/material_tables.h"
#include "traces/accel/memory_image.h"

namespace traces {

/// Triangles, instance by instance or mesh by mesh; the arrays have the same index.
struct FlatTriangles {
  std::vector<TriangleRecord> triangles;
  std::vector<AttributeRecord> attributes;
  std::vector<VertexRecord> vertices;  ///< empty if no material needs them
};

/// Object id of instance `i`.
inline std::uint32_t object_of(const Instance& instance, std::uint32_t i) {
  return i | (instance.focus ? kFocusObject : 0);
}

/// Appends a mesh, carried by `to_world`. `source` of its triangles is their index in `out` less `base`.
void append_mesh(const Mesh& mesh, const glm::mat4& to_world, std::uint32_t object, const MaterialTables& materials,
                 std::uint32_t base, FlatTriangles& out);
/// Makes room for so many triangles in all; InputError if that is too many.
void reserve(std::size_t triangles, const MaterialTables& materials, FlatTriangles& out);
/// InputError where the scene names what it does not have.
void check_meshes(const Scene& scene);

/// All triangles of a scene in world space.
FlatTriangles flatten(const Scene& scene, const MaterialTables& materials);

}  // namespace traces
