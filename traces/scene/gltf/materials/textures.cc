#include "traces/scene/gltf/materials/textures.h"

#include <algorithm>

#include <fmt/format.h>

#include "sim/io/printable.h"
#include "traces/scene/gltf/accessors.h"
#include "traces/scene/images.h"
#include "traces/scene/texture_mean.h"

namespace traces::gltf {
namespace {

Texture::Wrap wrap_of(int mode) {
  switch (mode) {
    case TINYGLTF_TEXTURE_WRAP_CLAMP_TO_EDGE:
      return Texture::Wrap::kClamp;
    case TINYGLTF_TEXTURE_WRAP_MIRRORED_REPEAT:
      return Texture::Wrap::kMirror;
    default:
      return Texture::Wrap::kRepeat;
  }
}

}  // namespace

int Textures::source_of(int texture) {
  const tinygltf::Texture& found = context_.at(context_.model.textures, texture, "textures");
  if (found.source < 0) context_.warn(fmt::format("textures[{}] names no PNG or JPEG image and is left out", texture));
  return found.source;
}

Texture& Textures::image(int index) {
  if (const auto found = images_.find(index); found != images_.end()) return found->second;
  const tinygltf::Image& image = context_.at(context_.model.images, index, "images");
  const std::string name = fmt::format("{}: images[{}]{}{}", context_.file, index, image.name.empty() ? "" : " ",
                                       sim::printable(image.name));
  std::span<const std::byte> bytes;
  if (image.bufferView >= 0) {
    const Bytes view = view_bytes(context_, image.bufferView);
    bytes = std::as_bytes(std::span(view.data, view.size));
  } else {
    bytes = std::as_bytes(std::span(image.image));
  }
  SceneLimits limits = context_.limits;
  limits.pixels = std::min(limits.pixels - pixels_, context_.budget.left() / (2 * sizeof(std::uint32_t)));
  Texture texture = read_image(bytes, name, limits);
  count_pixels(texture, name);
  context_.budget.take(texture.texels.size(), sizeof(std::uint32_t), name);
  texture.name = sim::printable(image.name);
  return images_.emplace(index, std::move(texture)).first->second;
}

void Textures::count_pixels(const Texture& texture, const std::string& name) {
  if (texture.texels.size() > context_.limits.pixels - pixels_) {
    context_.refuse(
        fmt::format("{}: all images together have more than limits.pixels, {}", name, context_.limits.pixels));
  }
  pixels_ += texture.texels.size();
}

std::uint32_t Textures::use(int texture, bool srgb) {
  const int source = source_of(texture);
  if (source < 0) return kNoTexture;
  tinygltf::Sampler sampler;
  const int sampler_index = context_.model.textures[static_cast<std::size_t>(texture)].sampler;
  if (sampler_index >= 0) sampler = context_.at(context_.model.samplers, sampler_index, "samplers");
  const bool nearest = sampler.magFilter == TINYGLTF_TEXTURE_FILTER_NEAREST;
  const auto [entry, is_new] = added_.try_emplace({source, sampler.wrapS, sampler.wrapT, nearest, srgb},
                                                  static_cast<std::uint32_t>(context_.scene.textures.size()));
  if (is_new) {
    Texture copy = image(source);
    if (!shown_.insert(source).second) count_pixels(copy, copy.name);
    context_.budget.take(copy.texels.size(), sizeof(std::uint32_t), "a texture");
    copy.wrap_u = wrap_of(sampler.wrapS);
    copy.wrap_v = wrap_of(sampler.wrapT);
    copy.filter = nearest ? Texture::Filter::kNearest : Texture::Filter::kLinear;
    copy.srgb = srgb;
    context_.scene.textures.push_back(std::move(copy));
  }
  return entry->second;
}

glm::vec4 Textures::mean(int texture, bool srgb) {
  const int source = source_of(texture);
  if (source < 0) return glm::vec4(1);
  const auto [entry, is_new] = means_.try_emplace({source, srgb}, glm::vec4(1));
  if (is_new) {
    image(source).srgb = srgb;
    entry->second = mean_texel(image(source));
  }
  return entry->second;
}

}  // namespace traces::gltf
