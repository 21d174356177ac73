#pragma once
#include <string_view>

#include "shader_kernels/ports.h"

namespace kernels {

/// The second inspector: a surface goes into the stream of every class that it belongs to.
struct ClassifySurfaces {
  static constexpr std::string_view kName = "classify_surfaces";
  static constexpr std::string_view kMeaning = "surface -> streams textured, diffuse, mirror, glass, emissive";
  template <class V>
  struct Ports {
    Local<V, WordRecord> surfaces;
    Local<V, MatteRecord> mattes;
    Local<V, WordRecord> textured, diffuse, mirror, glass, emissive;
    Counter<V> textured_count, diffuse_count, mirror_count, glass_count, emissive_count;
    static void describe(auto& p, auto&& port) {
      port(p.surfaces, "surfaces");
      port(p.mattes, "mattes");
      port(p.textured, "textured");
      port(p.diffuse, "diffuse");
      port(p.mirror, "mirror");
      port(p.glass, "glass");
      port(p.emissive, "emissive");
      port(p.textured_count, "textured_count");
      port(p.diffuse_count, "diffuse_count");
      port(p.mirror_count, "mirror_count");
      port(p.glass_count, "glass_count");
      port(p.emissive_count, "emissive_count");
    }
  };
  template <class V>
  static void body(const I<V>& item, Ports<V>& at) {
    const I<V> slot = at.surfaces.load(item).word;
    const I<V> classes = at.mattes.load(slot).classes;
    const auto append = [&](Class bit, const auto& stream, auto& count) {
      stream.store(count.next(I<V>(0U) < (classes & static_cast<std::uint32_t>(bit))), {slot});
    };
    append(kTextured, at.textured, at.textured_count);
    append(kDiffuse, at.diffuse, at.diffuse_count);
    append(kMirror, at.mirror, at.mirror_count);
    append(kGlass, at.glass, at.glass_count);
    append(kEmissive, at.emissive, at.emissive_count);
  }
};

}  // namespace kernels
