#pragma once
#include <string_view>

#include "shader_kernels/kernels/arithmetic.h"
#include "shader_kernels/ports.h"
#include "traces/ray.h"

namespace kernels {

/// Sorts the ray slots of a tile into a list of misses and a list of hits.
struct ClassifyHits {
  static constexpr std::string_view kName = "classify_hits";
  static constexpr std::string_view kMeaning = "ray slot -> stream of misses or stream of hits";
  template <class V>
  struct Ports {
    Local<V, HitRecord> hits;
    Local<V, WordRecord> misses, surfaces;
    Counter<V> miss_count, surface_count;
    static constexpr void describe(auto& p, auto&& port) {
      name_all(port, NAMED_ALL(p.hits, p.misses, p.surfaces, p.miss_count, p.surface_count));
    }
  };
  template <class V>
  static void body(const I<V>& item, Ports<V>& io) {
    const I<V> triangle = io.hits.load(item).triangle;
    io.misses.store(io.miss_count.next_index(triangle == traces::kNoHit), {item});
    io.surfaces.store(io.surface_count.next_index(triangle < traces::kNoHit), {item});
  }
};

/// Appends the surface in ray slot `slot` to the list `stream` if the surface has the material class `bit`.
template <class V>
void append_if_class_set(const I<V>& slot, const I<V>& classes, traces::MaterialFlag bit,
                         const Local<V, WordRecord>& stream, Counter<V>& count) {
  stream.store(count.next_index(has_flag<V>(classes, bit)), {slot});
}

/// Sorts surfaces by material: appends each surface to the lists of all common material classes that it has.
struct ClassifySurfaces {
  static constexpr std::string_view kName = "classify_surfaces";
  static constexpr std::string_view kMeaning = "surface -> streams textured, diffuse, mirror, glass, emissive";
  template <class V>
  struct Ports {
    Local<V, WordRecord> surfaces;
    Local<V, DiffuseRecord> mattes;
    Local<V, WordRecord> textured, diffuse, mirror, glass, emissive;
    Counter<V> textured_count, diffuse_count, mirror_count, glass_count, emissive_count;
    static constexpr void describe(auto& p, auto&& port) {
      name_all(port, NAMED_ALL(p.surfaces, p.mattes, p.textured, p.diffuse, p.mirror, p.glass, p.emissive,
                               p.textured_count, p.diffuse_count, p.mirror_count, p.glass_count, p.emissive_count));
    }
  };
  template <class V>
  static void body(const I<V>& item, Ports<V>& io) {
    const I<V> slot = io.surfaces.load(item).word;
    const I<V> classes = io.mattes.load(slot).classes;
    append_if_class_set<V>(slot, classes, traces::kTextured, io.textured, io.textured_count);
    append_if_class_set<V>(slot, classes, traces::kDiffuse, io.diffuse, io.diffuse_count);
    append_if_class_set<V>(slot, classes, traces::kMirror, io.mirror, io.mirror_count);
    append_if_class_set<V>(slot, classes, traces::kGlass, io.glass, io.glass_count);
    append_if_class_set<V>(slot, classes, traces::kEmissive, io.emissive, io.emissive_count);
  }
};

/// Sorts surfaces by material: appends each surface to the lists of all rare material classes that it has. Launched
/// only if the scene has such a class.
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
    static constexpr void describe(auto& p, auto&& port) {
      name_all(port, NAMED_ALL(p.surfaces, p.mattes, p.absorbing, p.vertexed, p.based, p.physical, p.bumped, p.blended,
                               p.glowing, p.occluded, p.absorbing_count, p.vertexed_count, p.based_count,
                               p.physical_count, p.bumped_count, p.blended_count, p.glowing_count, p.occluded_count));
    }
  };
  template <class V>
  static void body(const I<V>& item, Ports<V>& io) {
    const I<V> slot = io.surfaces.load(item).word;
    const I<V> classes = io.mattes.load(slot).classes;
    append_if_class_set<V>(slot, classes, traces::kAbsorbing, io.absorbing, io.absorbing_count);
    append_if_class_set<V>(slot, classes, traces::kVertexed, io.vertexed, io.vertexed_count);
    append_if_class_set<V>(slot, classes, traces::kBased, io.based, io.based_count);
    append_if_class_set<V>(slot, classes, traces::kPhysical, io.physical, io.physical_count);
    append_if_class_set<V>(slot, classes, traces::kBumped, io.bumped, io.bumped_count);
    append_if_class_set<V>(slot, classes, traces::kBlended, io.blended, io.blended_count);
    append_if_class_set<V>(slot, classes, traces::kGlowing, io.glowing, io.glowing_count);
    append_if_class_set<V>(slot, classes, traces::kOccluded, io.occluded, io.occluded_count);
  }
};

/// Lists interpolated surfaces with an occlusion texture. Other texture details need no list, because the interpolated
/// records already contain their results.
struct ClassifyOccluded {
  static constexpr std::string_view kName = "classify_occluded";
  static constexpr std::string_view kMeaning = "interpolated surface -> stream occluded";
  template <class V>
  struct Ports {
    Local<V, WordRecord> surfaces;
    Local<V, DiffuseRecord> mattes;
    Local<V, WordRecord> occluded;
    Counter<V> occluded_count;
    static constexpr void describe(auto& p, auto&& port) {
      name_all(port, NAMED_ALL(p.surfaces, p.mattes, p.occluded, p.occluded_count));
    }
  };
  template <class V>
  static void body(const I<V>& item, Ports<V>& io) {
    const I<V> slot = io.surfaces.load(item).word;
    append_if_class_set<V>(slot, io.mattes.load(slot).classes, traces::kOccluded, io.occluded, io.occluded_count);
  }
};

/// True if a hit must be tested for transparency. `triangle`: word of the hit triangle, with flags in the high bits and
/// its index in the low bits. A word of at most `solid` needs no test.
template <class V>
M<V> needs_transparency_test(const I<V>& triangle, const I<V>& solid) {
  return logical_and(solid < triangle, triangle < traces::kNoHit);
}

/// Lists the hits on triangles flagged as possibly transparent, where the ray may have to continue.
struct ClassifyLayers {
  static constexpr std::string_view kName = "classify_layers";
  static constexpr std::string_view kMeaning = "ray slot -> stream of hits that a texture or a tint decides about";
  template <class V>
  struct Ports {
    Local<V, HitRecord> hits;
    Local<V, WordRecord> layers;
    Counter<V> layer_count;
    I<V> solid;
    static constexpr void describe(auto& p, auto&& port) {
      name_all(port, NAMED_ALL(p.hits, p.layers, p.layer_count, p.solid));
    }
  };
  template <class V>
  static void body(const I<V>& item, Ports<V>& io) {
    const I<V> triangle = io.hits.load(item).triangle;
    io.layers.store(io.layer_count.next_index(needs_transparency_test<V>(triangle, io.solid)), {item});
  }
};

}  // namespace kernels
