#pragma once
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <glm/mat4x4.hpp>

#include "traces/accel/build/material_tables.h"
#include "traces/accel/memory_image.h"

namespace traces {

/// A mesh and the space in which its triangles are stored.
struct PlacedMesh {
  const Mesh* mesh = nullptr;
  glm::mat4 to_space{1};     ///< matrix from the mesh's space to that of the stored triangles
  std::uint32_t object = 0;  ///< object id of its triangles (TriangleRecord::object)
};

/// Records that shading kernels read for each triangle, in the order of the triangles.
struct ShadingRecords {
  std::vector<AttributeRecord> attributes;
  std::vector<VertexRecord> vertices;  ///< empty if no material needs vertex records
};

/// Returns the object id that hits on the instance with index `instance_index` have.
inline std::uint32_t object_id_of(const Instance& instance, std::uint32_t instance_index) {
  return instance_index | (instance.focus ? kFocusObject : 0);
}

/// Returns the meshes of all instances with their matrices to world space. Throws InputError for invalid references.
std::vector<PlacedMesh> placed_instances(const Scene& scene);
/// Throws InputError if a mesh of the scene has invalid references.
void check_meshes(const Scene& scene);

/// Appends the triangle records of a mesh. Their `source` numbers begin at `base`.
void append_triangles(const PlacedMesh& placed, const MaterialTables& materials, std::size_t base,
                      std::vector<TriangleRecord>& out);
/// Returns the triangles of all meshes, with consecutive `source` numbers. Throws InputError if there are too many.
std::vector<TriangleRecord> triangle_records(std::span<const PlacedMesh> placed, const MaterialTables& materials);
/// Returns the shading records of the triangles that triangle_records() returns. A separate function, so that these
/// records need no memory while the tree is built.
ShadingRecords shading_records(std::span<const PlacedMesh> placed, const MaterialTables& materials);

/// Throws InputError if there are more than kMaxTriangles triangles.
void check_triangle_count(std::size_t triangles);

}  // namespace traces
