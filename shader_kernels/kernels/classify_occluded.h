#pragma once
#include <string_view>

#include "shader_kernels/kernels/classify_surfaces.h"
#include "sim/named.h"

namespace kernels {

/// The inspector of interpolated surfaces in scenes with occlusion textures. All else that classify_details looks for
/// is in what their references have kept.
struct ClassifyOccluded {
  static constexpr std::string_view kName = "classify_occluded";
  static constexpr std::string_view kMeaning = "interpolated surface -> stream occluded";
  template <class V>
  struct Ports {
    Local<V, WordRecord> surfaces;
    Local<V, DiffuseRecord> mattes;
    Local<V, WordRecord> occluded;
    Counter<V> occluded_count;
    static void describe(auto& p, auto&& port) {
      port(NAMED(p.surfaces));
      port(NAMED(p.mattes));
      port(NAMED(p.occluded));
      port(NAMED(p.occluded_count));
    }
  };
  template <class V>
  static void body(const I<V>& item, Ports<V>& at) {
    const I<V> slot = at.surfaces.load(item).word;
    append_if<V>(slot, at.mattes.load(slot).classes, traces::kOccluded, at.occluded, at.occluded_count);
  }
};

}  // namespace kernels
