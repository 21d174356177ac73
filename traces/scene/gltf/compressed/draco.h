#pragma once
#include <tiny_gltf.h>

#include "traces/scene/gltf/context.h"

namespace traces::gltf {

/// Decodes all primitives that use KHR_draco_mesh_compression into new buffers and accessors, as in an uncompressed
/// file. `model` is the one that `context` refers to. Memory is taken from the budget before Draco allocates it,
/// whatever the data claim.
void expand_draco(Context& context, tinygltf::Model& model);

}  // namespace traces::gltf
