#pragma once
#include <tiny_gltf.h>

#include "traces/scene/gltf/source.h"

namespace traces::gltf {

/// Parses the source by tinygltf, which gets no access to the file system: it sees what the source has read. Images
/// stay encoded, in Image::image if they are not in a buffer view. What tinygltf dislikes but reads is not reported, as
/// it counts optional properties (Skin::inverseBindMatrices) among that, and check_properties() has reported the rest.
tinygltf::Model parse_model(const Source& source);

}  // namespace traces::gltf
