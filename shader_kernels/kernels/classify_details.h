#pragma once
#include <string_view>

#include "shader_kernels/kernels/classify_surfaces.h"
#include "sim/named.h"

namespace kernels {

/// The inspector of what only some scenes have; launched where the scene has any of it.
struct ClassifyDetails {
  static constexpr std::string_view kName = "classify_details";
  static constexpr std::string_view kMeaning = "surface -> streams absorbing, vertexed, based, physical, bumped, ...";
  template <class V>
  struct Ports {
    Local<V, WordRecord> surfaces;
    Local<V, DiffuseRecord> mattes;
    Local<V, WordRecord> absorbing, vertexed, based, physical, bumped, blended, glowing, occluded;
    Counter<V> absorbing_count, vertexed_count, based_count, physical_count, bumped_count, blended_count, glowing_count,
        occluded_count;
    static void describe(auto& p, auto&& port) {
      port(NAMED(p.surfaces));
      port(NAMED(p.mattes));
      port(NAMED(p.absorbing));
      port(NAMED(p.vertexed));
      port(NAMED(p.based));
      port(NAMED(p.physical));
      port(NAMED(p.bumped));
      port(NAMED(p.blended));
      port(NAMED(p.glowing));
      port(NAMED(p.occluded));
      port(NAMED(p.absorbing_count));
      port(NAMED(p.vertexed_count));
      port(NAMED(p.based_count));
      port(NAMED(p.physical_count));
      port(NAMED(p.bumped_count));
      port(NAMED(p.blended_count));
      port(NAMED(p.glowing_count));
      port(NAMED(p.occluded_count));
    }
  };
  template <class V>
  static void body(const I<V>& item, Ports<V>& at) {
    const I<V> slot = at.surfaces.load(item).word;
    const I<V> classes = at.mattes.load(slot).classes;
    append_if<V>(slot, classes, traces::kAbsorbing, at.absorbing, at.absorbing_count);
    append_if<V>(slot, classes, traces::kVertexed, at.vertexed, at.vertexed_count);
    append_if<V>(slot, classes, traces::kBased, at.based, at.based_count);
    append_if<V>(slot, classes, traces::kPhysical, at.physical, at.physical_count);
    append_if<V>(slot, classes, traces::kBumped, at.bumped, at.bumped_count);
    append_if<V>(slot, classes, traces::kBlended, at.blended, at.blended_count);
    append_if<V>(slot, classes, traces::kGlowing, at.glowing, at.glowing_count);
    append_if<V>(slot, classes, traces::kOccluded, at.occluded, at.occluded_count);
  }
};

}  // namespace kernels
