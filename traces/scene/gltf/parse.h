#pragma once
#include <tiny_gltf.h>

#include "traces/scene/gltf/source.h"

namespace traces::gltf {

/// Hands the source to tinygltf, which gets no access to the file system: it sees the files that the source has read.
/// Images are kept encoded, in Image::image where they do not lie in a buffer view. `complaint` is what tinygltf found
/// wrong but read nevertheless, or empty.
tinygltf::Model parse_model(const Source& source, std::string& complaint);

}  // namespace traces::gltf
