#pragma once
#include <string_view>

#include "shader_kernels/kernels/arithmetic.h"
#include "shader_kernels/ports.h"
#include "sim/named.h"

namespace kernels {

/// Appends a surface to a stream if its classes have the stream's bit.
template <class V>
void append_if(const I<V>& slot, const I<V>& classes, traces::MaterialFlag bit, const Local<V, WordRecord>& stream,
               Counter<V>& count) {
  stream.store(count.next(has<V>(classes, bit)), {slot});
}

/// The second inspector: a surface goes into the stream of every class that it belongs to.
struct ClassifySurfaces {
  static constexpr std::string_view kName = "classify_surfaces";
  static constexpr std::string_view kMeaning = "surface -> streams textured, diffuse, mirror, glass, emissive";
  template <class V>
  struct Ports {
    Local<V, WordRecord> surfaces;
    Local<V, DiffuseRecord> mattes;
    Local<V, WordRecord> textured, diffuse, mirror, glass, emissive;
    Counter<V> textured_count, diffuse_count, mirror_count, glass_count, emissive_count;
    static void describe(auto& p, auto&& port) {
      port(NAMED(p.surfaces));
      port(NAMED(p.mattes));
      port(NAMED(p.textured));
      port(NAMED(p.diffuse));
      port(NAMED(p.mirror));
      port(NAMED(p.glass));
      port(NAMED(p.emissive));
      port(NAMED(p.textured_count));
      port(NAMED(p.diffuse_count));
      port(NAMED(p.mirror_count));
      port(NAMED(p.glass_count));
      port(NAMED(p.emissive_count));
    }
  };
  template <class V>
  static void body(const I<V>& item, Ports<V>& at) {
    const I<V> slot = at.surfaces.load(item).word;
    const I<V> classes = at.mattes.load(slot).classes;
    append_if<V>(slot, classes, traces::kTextured, at.textured, at.textured_count);
    append_if<V>(slot, classes, traces::kDiffuse, at.diffuse, at.diffuse_count);
    append_if<V>(slot, classes, traces::kMirror, at.mirror, at.mirror_count);
    append_if<V>(slot, classes, traces::kGlass, at.glass, at.glass_count);
    append_if<V>(slot, classes, traces::kEmissive, at.emissive, at.emissive_count);
  }
};

}  // namespace kernels
