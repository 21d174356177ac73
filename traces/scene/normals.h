#pragma once
#include <cstdint>
#include <vector>

#include "traces/scene/scene.h"

namespace traces {

/// Gives every triangle its own vertices with its geometric normal, as glTF demands where a file has no normals.
/// Returns the old vertex of each new vertex.
std::vector<std::uint32_t> flatten_normals(Mesh& mesh);

/// Returns for every vertex the normal of the last triangle that uses it: for meshes with flat normals.
std::vector<glm::vec3> triangle_normals(const Mesh& mesh);

/// Makes normals unit length; a zero normal becomes the geometric normal of a triangle that uses the vertex.
void repair_normals(Mesh& mesh);

}  // namespace traces
