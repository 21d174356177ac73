#pragma once
#include <cstdint>
#include <vector>

#include "traces/scene/scene.h"

namespace traces {

/// Gives every triangle vertices of its own with its geometric normal, as glTF asks where a file has no normals.
/// Returns for each new vertex the old one it is a copy of.
std::vector<std::uint32_t> flatten_normals(Mesh& mesh);

/// A normal for every vertex, that of the last triangle that uses it: for meshes with flat normals.
std::vector<glm::vec3> triangle_normals(const Mesh& mesh);

/// Makes given normals unit length; where one is null, the geometric normal of a triangle that uses the vertex.
void repair_normals(Mesh& mesh);

}  // namespace traces
