#pragma once
#include <tiny_gltf.h>

#include "traces/scene/gltf/context.h"

namespace traces::gltf {

/// Decodes all primitives that use KHR_draco_mesh_compression into new buffers and accessors, as in an uncompressed
/// file. `context` must refer to `model`. Memory is taken from the budget before Draco allocates it, so that data
/// cannot demand too much.
void expand_draco(Context& context, tinygltf::Model& model);

/// Decodes each buffer view that uses EXT_meshopt_compression or KHR_meshopt_compression into a buffer of its own.
/// `context` must refer to `model`.
void expand_meshopt(Context& context, tinygltf::Model& model);

}  // namespace traces::gltf
