#pragma once
#include "traces/scene/gltf/context.h"

namespace traces::gltf {

/// Fills Scene::tracks from all animations, which play at once: where two move the same property of a node, the first
/// counts. Channels of nodes that are not shown are left out. Needs Context::scene_nodes and the nodes' morph weights.
/// Refused: key times that fall, lists of the wrong length, numbers that are not finite.
void read_animations(Context& context);

}  // namespace traces::gltf
