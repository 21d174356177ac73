#pragma once
#include <cstdint>
#include <map>
#include <set>
#include <string>
#include <tuple>

#include <glm/vec4.hpp>

#include "traces/scene/gltf/context.h"

namespace traces::gltf {

/// Decodes an image when a material first uses it; unused images are never decoded.
class Textures {
 public:
  explicit Textures(Context& context) : context_(context) {}

  /// Returns the Scene::textures index of glTF texture `texture`, read as colour (`srgb`) or as numbers; kNoTexture if
  /// it has no readable image.
  std::uint32_t use(int texture, bool srgb);

  /// Returns the mean of all texels, 0..1, alpha included; linear colour if `srgb`. White if the texture has no image.
  glm::vec4 mean(int texture, bool srgb);

 private:
  Texture& image(int index);
  int source_of(int texture);
  /// Adds the texture's pixels; refused if the scene then exceeds its limit.
  void count_pixels(const Texture& texture, const std::string& name);

  Context& context_;
  std::map<int, Texture> images_;
  std::set<int> shown_;       ///< images that a texture of the scene shows
  std::uint64_t pixels_ = 0;  ///< decoded, including copies for other wrap modes, filters or encodings
  std::map<std::pair<int, bool>, glm::vec4> means_;
  std::map<std::tuple<int, int, int, bool, bool>, std::uint32_t> added_;  ///< key: image, wrap modes, nearest, sRGB
};

}  // namespace traces::gltf
