#pragma once
#include <string>
#include <vector>

#include "traces/scene/gltf/context.h"

namespace traces::gltf {

/// Reads EXT_mesh_gpu_instancing: the places of the node's mesh, in the node's space; empty if the node does not use
/// the extension.
std::vector<Transform> read_instancing(Context& context, const tinygltf::Node& node, const std::string& what);

}  // namespace traces::gltf
