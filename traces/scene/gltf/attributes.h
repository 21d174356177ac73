#pragma once
#include <string>

#include "traces/scene/gltf/context.h"
#include "traces/scene/gltf/materials/placements.h"

namespace traces::gltf {

/// Returns the accessor index of the primitive's attribute of that name, or -1.
int attribute(const tinygltf::Primitive& primitive, const std::string& name);

// These fill `mesh`, whose material and positions are set. Refused: a number of values other than that of positions.
void read_normals(Context& context, const tinygltf::Primitive& primitive, Mesh& mesh);
void read_uvs(Context& context, const tinygltf::Primitive& primitive, const Placements& placements, Mesh& mesh);
void read_tangents(Context& context, const tinygltf::Primitive& primitive, Mesh& mesh);
/// Reads COLOR_0, 0..1; leaves the colours empty if all are white and opaque.
void read_colours(Context& context, const tinygltf::Primitive& primitive, Mesh& mesh);

}  // namespace traces::gltf
