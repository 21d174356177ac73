#pragma once
#include <tiny_gltf.h>

#include "traces/scene/gltf/source.h"

namespace traces::gltf {

/// Parses the source by tinygltf without access to the file system. Images remain encoded, in Image::image if they are
/// not in a buffer view. tinygltf's warnings are dropped: it reports missing optional properties, and
/// check_properties() has found the other faults.
tinygltf::Model parse_model(const Source& source);

}  // namespace traces::gltf
