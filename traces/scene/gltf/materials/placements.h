#pragma once
#include <string>
#include <vector>

#include <glm/vec2.hpp>

#include "traces/scene/gltf/context.h"

namespace traces::gltf {

/// How a texture finds its texel: which of the primitive's sets of coordinates, and KHR_texture_transform.
struct TexturePlacement {
  int set = 0;
  glm::vec2 offset{0}, scale{1};
  float rotation = 0;
  glm::vec2 apply(const glm::vec2& uv) const;
  friend bool operator==(const TexturePlacement&, const TexturePlacement&) = default;
};

/// Reads that of a glTF texture reference with that `texCoord` and those extensions.
TexturePlacement read_placement(const Context& context, int set, const tinygltf::ExtensionMap& extensions);

/// The placements that a material's textures use: at most two, for Mesh::uvs and Mesh::second_uvs.
class Placements {
 public:
  /// Whether a texture so placed is looked up with the second coordinates. A third placement is told in a warning that
  /// names the material, and uses the first.
  bool is_second(Context& context, const TexturePlacement& placement, const std::string& material);

  const std::vector<TexturePlacement>& list() const { return list_; }

 private:
  std::vector<TexturePlacement> list_;
};

}  // namespace traces::gltf
