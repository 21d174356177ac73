#pragma once
#include "traces/scene/gltf/context.h"
#include "traces/scene/gltf/meshes.h"

namespace traces::gltf {

/// Adds the nodes of the default scene (else the first) to Scene::nodes, with an instance per primitive shown, cameras
/// and lights. An instance is in focus if the extras of its node or mesh say `"focus": true`. Refused: cycles, a node
/// with two parents, transforms that are not finite.
void read_nodes(Context& context, Meshes& meshes);

}  // namespace traces::gltf
