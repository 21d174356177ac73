#pragma once
#include "traces/scene/gltf/context.h"

namespace traces::gltf {

/// Fills Scene::tracks from all animations, which play at once. If two move the same property of a node, the first is
/// used. Channels of nodes that are not shown are left out. Requires Context::scene_nodes and the nodes' morph weights.
/// Refused: descending key times, lists of the wrong length, numbers that are not finite.
void read_animations(Context& context);

}  // namespace traces::gltf
