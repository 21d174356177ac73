#include "traces/scene/gltf/materials/placements.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "traces/scene/gltf/values.h"

namespace traces::gltf {

glm::vec2 TexturePlacement::apply(const glm::vec2& uv) const {
  const glm::vec2 scaled = uv * scale;
  const float c = std::cos(rotation), s = std::sin(rotation);
  return offset + glm::vec2(c * scaled.x + s * scaled.y, -s * scaled.x + c * scaled.y);
}

TexturePlacement read_placement(const Context& context, int set, const tinygltf::ExtensionMap& extensions) {
  TexturePlacement placement;
  placement.set = set;
  const auto* transform = find_extension(extensions, "KHR_texture_transform");
  if (transform == nullptr) return placement;
  const auto pair = [&](const char* key, float absent, int i) {
    if (!transform->Has(key) || !transform->Get(key).IsArray() || transform->Get(key).ArrayLen() != 2) return absent;
    return to_float(context, transform->Get(key).Get(i).GetNumberAsDouble(), key);
  };
  placement.offset = {pair("offset", 0, 0), pair("offset", 0, 1)};
  placement.scale = {pair("scale", 1, 0), pair("scale", 1, 1)};
  placement.rotation = number_or(context, *transform, "rotation", 0);
  if (const int other = index_or_none(*transform, "texCoord"); other >= 0) placement.set = other;
  return placement;
}

bool Placements::is_second(Context& context, const TexturePlacement& placement, const std::string& material) {
  const auto found = std::ranges::find(list_, placement);
  if (found != list_.end()) return found != list_.begin();
  if (list_.size() == 2) {
    context.warn(fmt::format("{} places its textures in more than two ways; the further ones use the first", material));
    return false;
  }
  list_.push_back(placement);
  return list_.size() == 2;
}

}  // namespace traces::gltf
