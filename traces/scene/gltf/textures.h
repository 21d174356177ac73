#pragma once
#include <cstdint>
#include <map>
#include <tuple>

#include <glm/vec4.hpp>

#include "traces/scene/gltf/context.h"

namespace traces::gltf {

/// Decodes images when a material first asks for them; images that no material needs are never decoded.
class Textures {
 public:
  explicit Textures(Context& context) : context_(context) {}

  /// Index in Scene::textures of glTF texture `texture`, or kNoTexture where it names no image.
  std::uint32_t base_colour(int texture);

  /// Mean of all texels, 0..1, alpha included; linear colour if `srgb`. White where the texture names no image.
  glm::vec4 mean(int texture, bool srgb);

 private:
  const Texture& image(int index);
  int source_of(int texture);

  Context& context_;
  std::map<int, Texture> images_;
  std::map<std::pair<int, bool>, glm::vec4> means_;
  std::map<std::tuple<int, int, int>, std::uint32_t> added_;  ///< by image and wrap modes
};

}  // namespace traces::gltf
