#pragma once
#include "traces/scene/gltf/context.h"
#include "traces/scene/gltf/meshes.h"

namespace traces::gltf {

/// Adds the nodes of the default scene (or of the first scene) with their cameras and lights to the scene. Each
/// primitive that a node shows becomes an instance. An instance is in focus if the extras of its node or mesh contain
/// `"focus": true`. Throws InputError for cycles, a node with two parents, and transforms that are not finite.
void read_nodes(Context& context, Meshes& meshes);

}  // namespace traces::gltf
