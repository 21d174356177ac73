#pragma once
#include <tiny_gltf.h>

#include "traces/scene/gltf/context.h"

namespace traces::gltf {

/// EXT_meshopt_compression and KHR_meshopt_compression: decodes every buffer view that has it into a buffer of its own.
/// `model` is the one that `context` shows.
void expand_meshopt(Context& context, tinygltf::Model& model);

}  // namespace traces::gltf
