#pragma once
#include <cstdint>
#include <map>
#include <vector>

#include "traces/scene/gltf_export/document.h"

namespace traces::gltf_export {

/// Writes a mesh when it is first used; later uses share its accessors.
class Meshes {
 public:
  Meshes(const Scene& scene, Document& out) : scene_(scene), out_(out) {}

  /// Returns the index of a glTF mesh whose primitives are these meshes of Scene::meshes.
  int mesh_of(const std::vector<std::uint32_t>& parts);

 private:
  const tinygltf::Primitive& primitive_of(std::uint32_t mesh);
  tinygltf::Primitive write(const Mesh& mesh);

  const Scene& scene_;
  Document& out_;
  std::map<std::uint32_t, tinygltf::Primitive> primitives_;
  std::map<std::vector<std::uint32_t>, int> meshes_;
};

}  // namespace traces::gltf_export
