#pragma once
#include "traces/scene/gltf/context.h"
#include "traces/scene/gltf/meshes.h"

namespace traces::gltf {

/// Adds the nodes of the default scene (or the first) to Scene::nodes, with an instance per primitive shown, cameras
/// and lights. An instance is in focus if the extras of its node or mesh contain `"focus": true`. Throws InputError for
/// cycles, a node with two parents, and transforms that are not finite.
void read_nodes(Context& context, Meshes& meshes);

}  // namespace traces::gltf
