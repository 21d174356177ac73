#pragma once
#include <cstddef>
#include <vector>

#include "sim/io/json.h"

namespace traces::gltf {

/// Changes JSON that glTF allows and tinygltf refuses; returns true if something changed. The JSON must have passed
/// check_properties().
///
/// - A buffer without bytes, which only holds the place of what is decompressed (EXT_meshopt_compression), gets a byte.
/// - An accessor of indices without a buffer view (sparse, all zeros, or KHR_draco_mesh_compression) gets the first
/// view.
///   Its index is appended to `lent`; after parsing, the view must be removed again.
bool make_parsable(sim::Json& json, std::vector<std::size_t>& lent);

}  // namespace traces::gltf
