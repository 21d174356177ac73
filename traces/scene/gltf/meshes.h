#pragma once
#include <cstdint>
#include <map>
#include <vector>

#include "traces/scene/gltf/context.h"
#include "traces/scene/gltf/materials.h"

namespace traces::gltf {

/// Reads a glTF mesh when a node first shows it; meshes that no node shows are left out of the scene.
class Meshes {
 public:
  Meshes(Context& context, std::vector<Placements> placements)
      : context_(context), placements_(std::move(placements)) {}

  /// Indices in Scene::meshes of its primitives that are triangles, strips or fans.
  const std::vector<std::uint32_t>& primitives_of(int mesh);

  /// The largest coordinate of a mesh of Scene::meshes.
  float reach_of(std::uint32_t mesh) const { return reaches_[mesh]; }

 private:
  Mesh read(const tinygltf::Primitive& primitive, const std::string& name);
  std::uint32_t material_of(const tinygltf::Primitive& primitive);
  /// Unlit surfaces have no diffuse light for vertex colours to tint: a copy of the material shines in their mean.
  void fold_colours(Mesh& mesh);

  Context& context_;
  std::vector<Placements> placements_;  ///< of the file's materials
  std::uint32_t default_material_ = kNone;
  std::map<int, std::vector<std::uint32_t>> read_;
  std::vector<float> reaches_;  ///< parallel to Scene::meshes
};

}  // namespace traces::gltf
