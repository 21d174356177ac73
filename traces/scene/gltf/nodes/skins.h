#pragma once
#include <cstdint>
#include <memory>
#include <vector>

#include "traces/scene/gltf/context.h"

namespace traces::gltf {

/// True if its vertices move by themselves, shown with glTF skin `skin` (-1: none).
bool deforms(const tinygltf::Primitive& primitive, int skin);

/// Source of a deforming mesh, given the mesh at rest. Vertex i of the mesh is vertex `from[i]` of the
/// primitive. JOINTS_n and WEIGHTS_n beyond the first set are folded into the four largest weights, with a warning;
/// morphed tangents are not followed. A primitive without joints has no skin.
std::shared_ptr<const Deformation> read_deformation(Context& context, const tinygltf::Primitive& primitive, int skin,
                                                    const Mesh& mesh, bool flat_normals,
                                                    const std::vector<std::uint32_t>& from);

/// After the nodes: fills Scene::skins, one per glTF skin that a mesh shown uses (others stay empty), and gives each
/// node that shows morph targets as many weights. Refused: joints that are not shown.
void finish_deformations(Context& context);

}  // namespace traces::gltf
