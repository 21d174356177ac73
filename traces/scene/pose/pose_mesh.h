#pragma once
#include <span>

#include <glm/mat4x3.hpp>

#include "traces/scene/scene.h"

namespace traces {

/// Computes positions, normals and tangents of a deforming mesh from its rest pose: morph targets, then the skin
/// (linear blend). Normals are transformed by the cofactors of the blended matrix, or recomputed from the triangles if
/// the file has none. `joints` map from bind pose to world. Returns true if anything changed.
bool deform(Mesh& mesh, std::span<const glm::dmat4x3> joints, std::span<const double> morph_weights);

}  // namespace traces
