#pragma once
#include <string>
#include <vector>

#include "traces/scene/gltf/context.h"

namespace traces::gltf {

/// EXT_mesh_gpu_instancing: where the node shows its mesh, in the node's space; empty where the node
/// does not have the extension.
std::vector<Transform> read_instancing(Context& context, const tinygltf::Node& node, const std::string& what);

}  // namespace traces::gltf
