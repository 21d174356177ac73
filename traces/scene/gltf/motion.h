#pragma once
#include <cstdint>
#include <memory>
#include <vector>

#include "traces/scene/gltf/context.h"

namespace traces::gltf {

/// True if the primitive has morph targets or is deformed by glTF skin `skin` (-1: none).
bool is_deforming(const tinygltf::Primitive& primitive, int skin);

/// Returns how a mesh deforms, given the mesh at rest. Vertex i of the mesh is vertex `from[i]` of the primitive. If a
/// vertex has more than one set of joints (JOINTS_n, WEIGHTS_n), the four largest weights are used, with a warning.
/// Without joints there is no skin. Not modelled: morphed tangents.
std::shared_ptr<const Deformation> read_deformation(Context& context, const tinygltf::Primitive& primitive, int skin,
                                                    const Mesh& mesh, bool flat_normals,
                                                    const std::vector<std::uint32_t>& from);

/// Fills Scene::skins with one entry per glTF skin; entries that no mesh of the scene uses stay empty. Also sizes the
/// nodes' morph weights. Call after read_nodes(). Throws InputError for joints that are not nodes of the scene.
void read_skins_and_morph_weights(Context& context);

/// Fills Scene::tracks from all animations, which play together. If two move the same property of a node, the first is
/// used. Channels of nodes that are not shown are omitted. Requires Context::scene_nodes and the nodes' morph weights.
/// Throws InputError for descending key times, lists of the wrong length, and numbers that are not finite.
void read_animations(Context& context);

}  // namespace traces::gltf
