#pragma once
#include <vector>

#include <glm/vec2.hpp>

#include "traces/scene/scene.h"

namespace traces {

/// Sets Mesh::tangents from the texture coordinates of its normal map: per vertex the mean direction in which u grows,
/// made perpendicular to the normal (Lengyel, "Computing Tangent Space Basis Vectors for an Arbitrary Mesh"). Any
/// perpendicular direction where the coordinates say nothing, and everywhere if `uvs` is empty. Needs unit normals.
void compute_tangents(Mesh& mesh, const std::vector<glm::vec2>& uvs);

}  // namespace traces
