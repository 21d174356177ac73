#pragma once
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "traces/scene/gltf/context.h"
#include "traces/scene/gltf/materials.h"

namespace traces::gltf {

/// Returns the accessor index of the glTF primitive's attribute called `name`, or -1.
int find_attribute(const tinygltf::Primitive& primitive, const std::string& name);

// These functions fill `mesh`, whose material and positions must be set. They throw InputError if the number of values
// differs from that of positions.
void read_normals(Context& context, const tinygltf::Primitive& primitive, Mesh& mesh);
void read_uvs(Context& context, const tinygltf::Primitive& primitive, const Placements& placements, Mesh& mesh);
void read_tangents(Context& context, const tinygltf::Primitive& primitive, Mesh& mesh);
/// Reads vertex colours (COLOR_0), 0..1. The colours stay empty if all are white and opaque.
void read_colours(Context& context, const tinygltf::Primitive& primitive, Mesh& mesh);

/// The meshes of a glTF file. A mesh is read when a node first shows it; a mesh that no node shows is not in the scene.
class Meshes {
 public:
  Meshes(Context& context, std::vector<Placements> placements)
      : context_(context), placements_(std::move(placements)) {}

  /// Returns the indices in Scene::meshes of the triangle primitives of glTF mesh `mesh`, for a node with glTF skin
  /// `skin` (-1: none). Deforming primitives are read again for each such node.
  std::vector<std::uint32_t> primitives_of(int mesh, int skin);

  /// Returns the largest absolute coordinate of mesh `mesh` of Scene::meshes.
  float largest_coordinate(std::uint32_t mesh) const { return largest_coordinates_[mesh]; }

 private:
  std::uint32_t add_mesh(const tinygltf::Primitive& primitive, const std::string& name, int skin);
  Mesh read_mesh(const tinygltf::Primitive& primitive, const std::string& name, int skin);
  std::uint32_t material_of(const tinygltf::Primitive& primitive);
  /// Gives an unlit mesh a copy of its material whose emission is multiplied by the mean of its vertex colours.
  void multiply_emission_by_vertex_colours(Mesh& mesh);

  Context& context_;
  std::vector<Placements> placements_;  ///< texture placements of each of the file's materials
  std::uint32_t default_material_ = kNone;
  std::map<std::pair<int, std::size_t>, std::uint32_t> read_;  ///< rigid meshes by glTF mesh and primitive
  std::vector<float> largest_coordinates_;  ///< for each of Scene::meshes, its largest absolute coordinate
};

}  // namespace traces::gltf
