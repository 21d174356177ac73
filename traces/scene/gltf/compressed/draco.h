#pragma once
#include <tiny_gltf.h>

#include "traces/scene/gltf/context.h"

namespace traces::gltf {

/// KHR_draco_mesh_compression: decodes every primitive that has it and gives the primitive accessors of its own on new
/// buffers, as if the file had been written without compression. `model` is the one that `context` shows. Memory is
/// taken from the budget before Draco takes it, whatever the data claim.
void expand_draco(Context& context, tinygltf::Model& model);

}  // namespace traces::gltf
