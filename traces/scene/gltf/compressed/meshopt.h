#pragma once
#include <tiny_gltf.h>

#include "traces/scene/gltf/context.h"

namespace traces::gltf {

/// Decodes each buffer view that uses EXT_meshopt_compression or KHR_meshopt_compression into a buffer of its own.
/// `model` is the one that `context` refers to.
void expand_meshopt(Context& context, tinygltf::Model& model);

}  // namespace traces::gltf
