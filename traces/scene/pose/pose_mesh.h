#pragma once
#include <span>

#include <glm/mat4x3.hpp>

#include "traces/scene/scene.h"

namespace traces {

/// Makes the positions, normals and tangents of a deforming mesh from its rest: morph targets first, then the skin
/// (linear blend). Normals are carried by the cofactors of the blended matrix; where none were given they are those of
/// the triangles. `joints` carry from bind pose to the world. True if anything differs from before.
bool deform(Mesh& mesh, std::span<const glm::dmat4x3> joints, std::span<const double> morph_weights);

}  // namespace traces
