#pragma once
#include <cstddef>
#include <vector>

#include <tiny_gltf.h>

#include "sim/io/json.h"
#include "traces/scene/gltf/source.h"

namespace traces::gltf {

/// Changes JSON that glTF allows and tinygltf rejects, so that tinygltf can parse it. Returns true if something
/// changed. The JSON must have passed check_properties().
///
/// - A buffer without bytes, a placeholder for decompressed data (EXT_meshopt_compression), gets one byte.
/// - An index accessor without a buffer view (sparse, all zeros, or KHR_draco_mesh_compression) gets the first view.
/// Its index is appended to `lent`; remove that view after parsing.
bool make_parsable(sim::Json& json, std::vector<std::size_t>& lent);

/// Parses the source with tinygltf, which has no access to the file system. Images remain encoded, in Image::image if
/// they are not in a buffer view. tinygltf's warnings are dropped: it reports missing optional properties, and
/// check_properties() has found the other errors.
tinygltf::Model parse_model(const Source& source);

}  // namespace traces::gltf
