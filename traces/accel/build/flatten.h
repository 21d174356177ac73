#pragma once
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <glm/mat4x4.hpp>

#include "traces/accel/build/material_tables.h"
#include "traces/accel/memory_image.h"

namespace traces {

/// A mesh as it is to lie in memory.
struct PlacedMesh {
  const Mesh* mesh = nullptr;
  glm::mat4 to_space{1};     ///< carries it to where its triangles are to be
  std::uint32_t object = 0;  ///< TriangleRecord::object
};

/// Records that shading reads, in the order of triangles.
struct ShadingRecords {
  std::vector<AttributeRecord> attributes;
  std::vector<VertexRecord> vertices;  ///< empty if no material needs them
};

/// Object id of instance `i`.
inline std::uint32_t object_of(const Instance& instance, std::uint32_t i) {
  return i | (instance.focus ? kFocusObject : 0);
}

/// Every instance in world space. InputError where the scene names what it does not have.
std::vector<PlacedMesh> placed_instances(const Scene& scene);
/// InputError where the scene names what it does not have.
void check_meshes(const Scene& scene);

/// Appends a mesh's triangles. Their `source` counts from triangle `base`.
void append_triangles(const PlacedMesh& placed, const MaterialTables& materials, std::size_t base,
                      std::vector<TriangleRecord>& out);
/// All of them, counted through. InputError if they are too many.
std::vector<TriangleRecord> triangles_of(std::span<const PlacedMesh> placed, const MaterialTables& materials);
/// Shading records of the same triangles; apart from them, as a tree is built meanwhile, which takes memory.
ShadingRecords shading_of(std::span<const PlacedMesh> placed, const MaterialTables& materials);

/// InputError if a scene has more triangles than there may be.
void check_count(std::size_t triangles);

}  // namespace traces
