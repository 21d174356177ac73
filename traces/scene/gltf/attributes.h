#pragma once
#include <string>

#include "traces/scene/gltf/context.h"
#include "traces/scene/gltf/materials/placements.h"

namespace traces::gltf {

/// Index of the primitive's accessor of that name, or -1.
int attribute(const tinygltf::Primitive& primitive, const std::string& name);

// They fill `mesh`, whose material and positions are known; refused: another count of values than of positions.
void read_normals(Context& context, const tinygltf::Primitive& primitive, Mesh& mesh);
void read_uvs(Context& context, const tinygltf::Primitive& primitive, const Placements& placements, Mesh& mesh);
void read_tangents(Context& context, const tinygltf::Primitive& primitive, Mesh& mesh);
/// COLOR_0, 0..1; nothing if all are white and opaque.
void read_colours(Context& context, const tinygltf::Primitive& primitive, Mesh& mesh);

}  // namespace traces::gltf
