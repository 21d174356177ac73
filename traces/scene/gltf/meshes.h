#pragma once
#include <cstdint>
#include <map>
#include <vector>

#include "traces/scene/gltf/context.h"
#include "traces/scene/gltf/materials/materials.h"

namespace traces::gltf {

/// Reads a glTF mesh when a node first shows it; meshes that no node shows are left out of the scene.
class Meshes {
 public:
  Meshes(Context& context, std::vector<Placements> placements)
      : context_(context), placements_(std::move(placements)) {}

  /// Returns the Scene::meshes indices of the mesh's triangle primitives as shown by a node with glTF skin `skin` (-1:
  /// none). Deforming primitives are read again for each such node.
  std::vector<std::uint32_t> primitives_of(int mesh, int skin);

  /// Returns the largest coordinate of a mesh of Scene::meshes.
  float reach_of(std::uint32_t mesh) const { return reaches_[mesh]; }

 private:
  std::uint32_t add(const tinygltf::Primitive& primitive, const std::string& name, int skin);
  Mesh read(const tinygltf::Primitive& primitive, const std::string& name, int skin);
  std::uint32_t material_of(const tinygltf::Primitive& primitive);
  /// Gives an unlit mesh a copy of its material whose emission is multiplied by the mean of its vertex colours.
  void fold_colours(Mesh& mesh);

  Context& context_;
  std::vector<Placements> placements_;  ///< of the file's materials
  std::uint32_t default_material_ = kNone;
  std::map<std::pair<int, std::size_t>, std::uint32_t> read_;  ///< rigid meshes, by mesh and primitive
  std::vector<float> reaches_;                                 ///< parallel to Scene::meshes
};

}  // namespace traces::gltf
