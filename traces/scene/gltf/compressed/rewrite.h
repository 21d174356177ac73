#pragma once
#include <nlohmann/json_fwd.hpp>

namespace traces::gltf {

/// tinygltf refuses two things that compressed files may say: a buffer without bytes, which only holds the place of
/// what is decompressed (EXT_meshopt_compression), and indices without a buffer view (KHR_draco_mesh_compression). This
/// gives the first a byte and the second the compressed view; both are replaced after parsing. Whether something
/// changed.
bool make_parsable(nlohmann::json& json);

}  // namespace traces::gltf
