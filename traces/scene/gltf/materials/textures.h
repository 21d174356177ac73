#pragma once
#include <cstdint>
#include <map>
#include <set>
#include <string>
#include <tuple>

#include <glm/vec4.hpp>

#include "traces/scene/gltf/context.h"

namespace traces::gltf {

/// Decodes images when a material first asks for them; images that no material needs are never decoded.
class Textures {
 public:
  explicit Textures(Context& context) : context_(context) {}

  /// Index in Scene::textures of glTF texture `texture`, to be read as colour (`srgb`) or as numbers; kNoTexture where
  /// it names no image that can be read.
  std::uint32_t use(int texture, bool srgb);

  /// Mean of all texels, 0..1, alpha included; linear colour if `srgb`. White where the texture names no image.
  glm::vec4 mean(int texture, bool srgb);

 private:
  Texture& image(int index);
  int source_of(int texture);
  /// Refused where the scene then has more than its limit.
  void count_pixels(const Texture& texture, const std::string& name);

  Context& context_;
  std::map<int, Texture> images_;
  std::set<int> shown_;       ///< images that a texture of the scene shows
  std::uint64_t pixels_ = 0;  ///< decoded, and copied for further ways to look them up
  std::map<std::pair<int, bool>, glm::vec4> means_;
  std::map<std::tuple<int, int, int, bool, bool>, std::uint32_t> added_;  ///< image, wrap modes, nearest, sRGB
};

}  // namespace traces::gltf
