#pragma once
#include <string_view>

#include "shader_kernels/kernels/add_light.h"
#include "shader_kernels/kernels/at_once.h"
#include "sim/named.h"

namespace kernels {

struct ShadeAmbient {
  static constexpr std::string_view kName = "shade_ambient";
  static constexpr std::string_view kMeaning = "diffuse surface -> ambient light into its sample";
  template <class V>
  struct Ports {
    Local<V, WordRecord> diffuse;
    Local<V, PathRecord> paths;
    Local<V, DiffuseRecord> mattes;
    Local<V, ColourRecord> colours;
    Vec3<V> ambient;
    static void describe(auto& p, auto&& port) {
      port(NAMED(p.diffuse));
      port(NAMED(p.paths));
      port(NAMED(p.mattes));
      port(NAMED(p.colours));
      port(NAMED(p.ambient));
    }
  };
  template <class V>
  static void body(const I<V>& item, Ports<V>& at) {
    shade<V>(at.diffuse.load(item).word, AllItems{}, at);
  }
  /// Acts where `mask` holds.
  template <class V>
  static void shade(const I<V>& slot, const auto& mask, Ports<V>& at) {
    const PathRecord<V> path = at.paths.load(slot);
    const Vec3<V> light = path.throughput * at.mattes.load(slot).diffuse * at.ambient;
    add_light<V>(at.colours, path.sample, where<V>(mask, light));
  }
};

}  // namespace kernels
