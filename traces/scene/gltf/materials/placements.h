#pragma once
#include <string>
#include <vector>

#include <glm/vec2.hpp>

#include "traces/scene/gltf/context.h"

namespace traces::gltf {

/// Texture coordinates of a texture: the set of the primitive, and KHR_texture_transform.
struct TexturePlacement {
  int set = 0;
  glm::vec2 offset{0}, scale{1};
  float rotation = 0;
  glm::vec2 apply(const glm::vec2& uv) const;
  friend bool operator==(const TexturePlacement&, const TexturePlacement&) = default;
};

/// Reads the placement of a glTF texture reference.
TexturePlacement read_placement(const Context& context, int set, const tinygltf::ExtensionMap& extensions);

/// The placements that a material's textures use: at most two, for Mesh::uvs and Mesh::second_uvs.
class Placements {
 public:
  /// True if a texture with this placement uses the second coordinates. A third placement adds a warning that names the
  /// material, and uses the first coordinates.
  bool is_second(Context& context, const TexturePlacement& placement, const std::string& material);

  const std::vector<TexturePlacement>& list() const { return list_; }

 private:
  std::vector<TexturePlacement> list_;
};

}  // namespace traces::gltf
