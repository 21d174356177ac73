#pragma once
#include "traces/scene/gltf/context.h"
#include "traces/scene/gltf/meshes.h"

namespace traces::gltf {

/// Walks the default scene's (else the first's) nodes from the roots, puts them into Scene::nodes, and adds an instance
/// for each primitive shown, a camera and a light where a node has one. An instance is in focus if the extras of its
/// node or mesh say `"focus": true`.  Refused: cycles, a node with two parents, transforms that are not finite.
void read_nodes(Context& context, Meshes& meshes);

}  // namespace traces::gltf
