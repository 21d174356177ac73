#include "traces/scene/gltf_export/textures.h"

#include <map>
#include <tuple>

#include "traces/scene/images.h"

namespace traces::gltf_export {
namespace {

int wrap_of(Texture::Wrap wrap) {
  switch (wrap) {
    case Texture::Wrap::kMirror:
      return TINYGLTF_TEXTURE_WRAP_MIRRORED_REPEAT;
    case Texture::Wrap::kClamp:
      return TINYGLTF_TEXTURE_WRAP_CLAMP_TO_EDGE;
    case Texture::Wrap::kRepeat:
      break;
  }
  return TINYGLTF_TEXTURE_WRAP_REPEAT;
}

int add_image(const Texture& texture, Document& out) {
  const std::string png = encode_png(texture);
  tinygltf::Image image;
  image.name = texture.name;
  image.mimeType = "image/png";
  image.bufferView = out.add_view(std::as_bytes(std::span(png)));
  out.model.images.push_back(image);
  return static_cast<int>(out.model.images.size()) - 1;
}

int add_sampler(const Texture& texture, Document& out) {
  const bool nearest = texture.filter == Texture::Filter::kNearest;
  tinygltf::Sampler sampler;
  sampler.magFilter = sampler.minFilter = nearest ? TINYGLTF_TEXTURE_FILTER_NEAREST : TINYGLTF_TEXTURE_FILTER_LINEAR;
  sampler.wrapS = wrap_of(texture.wrap_u);
  sampler.wrapT = wrap_of(texture.wrap_v);
  out.model.samplers.push_back(sampler);
  return static_cast<int>(out.model.samplers.size()) - 1;
}

}  // namespace

void write_textures(const Scene& scene, Document& out) {
  std::vector<int> images;
  std::map<std::tuple<Texture::Wrap, Texture::Wrap, Texture::Filter>, int> samplers;
  for (std::size_t i = 0; i < scene.textures.size(); ++i) {
    const Texture& texture = scene.textures[i];
    std::size_t same = 0;
    while (same < i && (scene.textures[same].width != texture.width || scene.textures[same].texels != texture.texels)) {
      ++same;
    }
    images.push_back(same < i ? images[same] : add_image(texture, out));
    const auto [sampler, is_new] = samplers.try_emplace({texture.wrap_u, texture.wrap_v, texture.filter}, 0);
    if (is_new) sampler->second = add_sampler(texture, out);
    tinygltf::Texture to;
    to.source = images.back();
    to.sampler = sampler->second;
    out.model.textures.push_back(to);
  }
}

}  // namespace traces::gltf_export
