#pragma once
#include <cstddef>
#include <vector>

#include <tiny_gltf.h>

#include "sim/io/json.h"
#include "traces/scene/gltf/source.h"

namespace traces::gltf {

/// Changes JSON that glTF allows and tinygltf refuses; returns true if something changed. Requires JSON that
/// check_properties() accepts.
///
/// - A buffer without bytes, a placeholder for decompressed data (EXT_meshopt_compression), gets one byte.
/// - An index accessor without a buffer view (sparse, all zeros, or KHR_draco_mesh_compression) gets the first view.
///   Its index is appended to `lent`; remove that view after parsing.
bool make_parsable(sim::Json& json, std::vector<std::size_t>& lent);

/// Parses the source by tinygltf without access to the file system. Images remain encoded, in Image::image if they are
/// not in a buffer view. tinygltf's warnings are dropped: it reports missing optional properties, and
/// check_properties() has found the other faults.
tinygltf::Model parse_model(const Source& source);

}  // namespace traces::gltf
