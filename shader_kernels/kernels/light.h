#pragma once
#include <cstdint>
#include <string_view>

#include "shader_kernels/kernels/arithmetic.h"
#include "shader_kernels/kernels/sampling.h"
#include "shader_kernels/kernels/uniforms.h"
#include "shader_kernels/ports.h"
#include "shader_kernels/records.h"
#include "sim/named.h"
#include "traces/ray.h"

namespace kernels {

/// Adds light to a sample's colour. If two items of one sample were in flight at once, the second would read a stale
/// sum. No interlock is modelled, because item lists keep such items far apart (one launch per light, reflections
/// before refractions).
template <class V>
[[gnu::always_inline]] inline void add_light(const Local<V, ColourRecord>& colours, const I<V>& sample,
                                             const Vec3<V>& light) {
  colours.store(sample, {colours.load(sample).rgb + light});
}

/// A mask that is true for every item of a kernel.
struct AllItems {};

/// Returns `value` if the mask is true, otherwise 0.
template <class V>
Vec3<V> masked_value(AllItems, const Vec3<V>& value) {
  return value;
}
template <class V>
Vec3<V> masked_value(const M<V>& mask, const Vec3<V>& value) {
  return select(mask, value, Vec3<V>{0.0F, 0.0F, 0.0F});
}
template <class V>
M<V> and_masks(AllItems, const M<V>& other) {
  return other;
}
template <class V>
M<V> and_masks(const M<V>& mask, const M<V>& other) {
  return logical_and(mask, other);
}

/// Material classes (textured, emissive, occluded) that delay the lighting of a surface. The kernels for these classes
/// change the surface's base colour, or change its light before all light sources are added.
inline constexpr std::uint32_t kDeferredClasses =
    traces::kTextured | traces::kEmissive | traces::kGlowing | traces::kOccluded;

/// True for surfaces that are diffuse and have no class in kDeferredClasses: they can be lit as soon as they are
/// fetched, because no texture, emission or occlusion must be applied first.
template <class V>
M<V> is_immediately_lit(const I<V>& classes) {
  return (classes & (kDeferredClasses | traces::kDiffuse)) == static_cast<std::uint32_t>(traces::kDiffuse);
}

/// Kernel that runs kernel K over the list of all surfaces, but lights only surfaces that can be lit immediately.
/// Without this wrapper K runs over the list of diffuse surfaces.
template <class K>
struct LightImmediately {
  using Of = K;
  template <class V>
  struct Ports : K::template Ports<V> {
    Local<V, WordRecord> surfaces;
    static constexpr void describe(auto& p, auto&& port) {
      port(NAMED(p.surfaces));
      K::template Ports<V>::describe(p, port);
    }
  };
  template <class V>
  static void body(const I<V>& item, Ports<V>& io) {
    const I<V> slot = io.surfaces.load(item).word;
    K::template shade_slot<V>(slot, is_immediately_lit<V>(io.mattes.load(slot).classes), io);
  }
};

/// Lists the diffuse surfaces whose lighting must wait for other kernels.
struct ListDeferred {
  template <class V>
  struct Ports {
    Local<V, WordRecord> surfaces;
    Local<V, DiffuseRecord> mattes;
    Local<V, WordRecord> deferred;
    Counter<V> deferred_count;
    static constexpr void describe(auto& p, auto&& port) {
      name_all(port, NAMED_ALL(p.surfaces, p.mattes));
      port(p.deferred, "later");
      port(p.deferred_count, "later_count");
    }
  };
  template <class V>
  static void body(const I<V>& item, Ports<V>& io) {
    const I<V> slot = io.surfaces.load(item).word;
    const I<V> classes = io.mattes.load(slot).classes;
    const M<V> is_deferred =
        logical_and(has_flag<V>(classes, traces::kDiffuse), I<V>(0U) < (classes & kDeferredClasses));
    io.deferred.store(io.deferred_count.next_index(is_deferred), {slot});
  }
};

/// Light from one light source that a diffuse surface scatters if nothing blocks the light source. It falls off with
/// the spot cone and the range as in glTF's KHR_lights_punctual.
template <class V>
struct DiffuseLight {
  Vec3<V> to_light;  ///< direction to the light source, not normalised: the source is at t = 1
  F<V> inverse_distance;
  Vec3<V> light;  ///< light including the path's throughput; no channel is above 0 if the surface faces away
};
/// A light source as it is seen from a surface, with nothing in between.
template <class V>
struct SeenLight {
  Vec3<V> to_light;  ///< direction to the light source, not normalised: the source is at t = 1
  F<V> inverse_distance;
  F<V> cosine;  ///< cosine of the angle between normal and direction; negative if the surface faces away
  F<V> share;   ///< irradiance per intensity, with the cosine
};
template <class V>
SeenLight<V> see_light(const SurfacePointRecord<V>& point, const LightUniforms<V>& light) {
  const Vec3<V> to_light = light.position - point.position * light.local;
  const F<V> squared = dot(to_light, to_light);
  const F<V> inverse_distance = 1.0F / sqrt(squared);
  const F<V> cosine = dot(point.normal, to_light) * inverse_distance;
  const F<V> off_axis = -dot(light.direction, to_light) * inverse_distance;
  const F<V> cone = min(max(off_axis * light.cone_scale + light.cone_offset, F<V>(0.0F)), F<V>(1.0F));
  const F<V> of_range = squared * light.inverse_range_squared;
  const F<V> window = max(1.0F - of_range * of_range, F<V>(0.0F));
  return {to_light, inverse_distance, cosine, cosine * (inverse_distance * inverse_distance) * (cone * cone) * window};
}
template <class V>
DiffuseLight<V> diffuse_light(const SurfacePointRecord<V>& point, const PathRecord<V>& path, const Vec3<V>& diffuse,
                              const LightUniforms<V>& light) {
  const SeenLight<V> seen = see_light<V>(point, light);
  return {seen.to_light, seen.inverse_distance, path.throughput * diffuse * (light.intensity * seen.share)};
}

struct ShadeBackground {
  static constexpr std::string_view kName = "shade_background";
  static constexpr std::string_view kMeaning = "miss -> background radiance into its sample";
  template <class V>
  struct Ports {
    Local<V, WordRecord> misses;
    Local<V, PathRecord> paths;
    Local<V, ColourRecord> colours;
    Vec3<V> background;
    static constexpr void describe(auto& p, auto&& port) {
      name_all(port, NAMED_ALL(p.misses, p.paths, p.colours, p.background));
    }
  };
  template <class V>
  static void body(const I<V>& item, Ports<V>& io) {
    const PathRecord<V> path = io.paths.load(io.misses.load(item).word);
    add_light<V>(io.colours, path.sample, path.throughput * io.background);
  }
};

/// Multiplies a surface's base colour by its base texture, for textures that use the first texture coordinates and no
/// alpha. Kernel shade_base handles other textures.
template <MipFilter kMips = MipFilter::kNone>
struct ShadeTextured {
  static constexpr std::string_view kName =
      variant_name_by_filter<kMips>("shade_textured", "shade_textured_mip", "shade_textured_trilinear");
  static constexpr std::string_view kMeaning = variant_name_by_filter<kMips>(
      "textured surface -> base colour times a bilinear fetch", "as shade_textured, from the nearest mip level",
      "as shade_textured, from two mip levels");
  template <class V>
  struct Ports : TexturePorts<V, kMips> {
    Local<V, WordRecord> textured;
    Local<V, TexcoordRecord> texcoords;
    Local<V, DiffuseRecord> mattes;
    Table<V, SrgbCodeRecord> srgb_codes;
    static constexpr void describe(auto& p, auto&& port) {
      TexturePorts<V, kMips>::describe(p, port);
      name_all(port, NAMED_ALL(p.textured, p.texcoords, p.mattes, p.srgb_codes));
    }
  };

  template <class V>
  static void body(const I<V>& item, Ports<V>& io) {
    const I<V> slot = io.textured.load(item).word;
    const TexcoordRecord<V> uv = io.texcoords.load(slot);
    const auto base = look_up<V>(uv, io);
    const DiffuseRecord<V> matte = io.mattes.load(slot);
    io.mattes.store(slot, {matte.diffuse * base.srgb_colour(io.srgb_codes), matte.classes});
  }

 private:
  template <class V>
  static auto look_up(const TexcoordRecord<V>& uv, const Ports<V>& io) {
    if constexpr (kMips == MipFilter::kNone) {
      return sample_texture<V>(io.axes, io.texels, uv.texture, uv.u, uv.v);
    } else {
      return io.sample_mip_level(texture_number<V, kMips>(uv), unpack_footprint<V>(uv.texture), uv.u, uv.v);
    }
  }
};

struct ShadeEmission {
  static constexpr std::string_view kName = "shade_emission";
  static constexpr std::string_view kMeaning = "emissive surface -> its own light into its sample";
  template <class V>
  struct Ports {
    Local<V, WordRecord> emissive;
    Local<V, SurfacePointRecord> points;
    Local<V, PathRecord> paths;
    Local<V, SpecularRecord> optics;
    Materials<V> materials;
    Local<V, ColourRecord> colours;
    static constexpr void describe(auto& p, auto&& port) {
      port(NAMED(p.emissive));
      port(p.points, "places");
      name_all(port, NAMED_ALL(p.paths, p.optics, p.materials, p.colours));
    }
  };
  template <class V>
  static void body(const I<V>& item, Ports<V>& io) {
    const I<V> slot = io.emissive.load(item).word;
    const PathRecord<V> path = io.paths.load(slot);
    const MaterialFields<V> material = io.materials.load(io.points.load(slot).material);
    add_light<V>(io.colours, path.sample, path.throughput * material.emission * io.optics.load(slot).kept);
  }
};

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
    static constexpr void describe(auto& p, auto&& port) {
      name_all(port, NAMED_ALL(p.diffuse, p.paths, p.mattes, p.colours, p.ambient));
    }
  };
  template <class V>
  static void body(const I<V>& item, Ports<V>& io) {
    shade_slot<V>(io.diffuse.load(item).word, AllItems{}, io);
  }
  /// Adds the ambient light at the surface in ray slot `slot` to its sample if `mask` is true.
  template <class V>
  static void shade_slot(const I<V>& slot, const auto& mask, Ports<V>& io) {
    const PathRecord<V> path = io.paths.load(slot);
    const Vec3<V> light = path.throughput * io.mattes.load(slot).diffuse * io.ambient;
    add_light<V>(io.colours, path.sample, masked_value<V>(mask, light));
  }
};

/// Computes the light that diffuse surfaces scatter from one light source and emits their shadow rays. One launch per
/// light.
struct ShadeDiffuse {
  static constexpr std::string_view kName = "shade_diffuse";
  static constexpr std::string_view kMeaning = "diffuse surface, one light -> shadow ray that brings its light";
  template <class V>
  struct Ports {
    Local<V, WordRecord> diffuse;
    Local<V, SurfacePointRecord> points;
    Local<V, PathRecord> paths;
    Local<V, DiffuseRecord> mattes;
    Local<V, RayRecord> shadow_rays;
    Local<V, PathRecord> shadow_paths;
    Counter<V> emitted;
    LightUniforms<V> light;
    F<V> epsilon;
    static constexpr void describe(auto& p, auto&& port) {
      port(NAMED(p.diffuse));
      port(p.points, "places");
      name_all(port, NAMED_ALL(p.paths, p.mattes, p.shadow_rays, p.shadow_paths, p.emitted));
      LightUniforms<V>::describe(p.light, port);
      port(NAMED(p.epsilon));
    }
  };
  template <class V>
  static void body(const I<V>& item, Ports<V>& io) {
    shade_slot<V>(io.diffuse.load(item).word, AllItems{}, io);
  }
  /// Emits the shadow ray of the surface in ray slot `slot` if `mask` is true.
  template <class V>
  static void shade_slot(const I<V>& slot, const auto& mask, Ports<V>& io) {
    const SurfacePointRecord<V> point = io.points.load(slot);
    const PathRecord<V> path = io.paths.load(slot);
    const auto [to_light, inverse_distance, light] =
        diffuse_light<V>(point, path, io.mattes.load(slot).diffuse, io.light);

    const I<V> out = io.emitted.next_index(and_masks<V>(mask, F<V>(0.0F) < max_channel(light)));
    const F<V> t_min = io.epsilon * inverse_distance;
    io.shadow_rays.store(out, {point.position, t_min, to_light, io.light.reach - t_min});
    io.shadow_paths.store(out, {light, path.sample});
  }
};

/// Adds the light of one light source to diffuse surfaces without a shadow ray; replaces the kernel shade_diffuse in
/// frames without shadows. One launch per light.
struct ShadeOpen {
  static constexpr std::string_view kName = "shade_open";
  static constexpr std::string_view kMeaning = "diffuse surface, one light -> its light into its sample, no shadow";
  template <class V>
  struct Ports {
    Local<V, WordRecord> diffuse;
    Local<V, SurfacePointRecord> points;
    Local<V, PathRecord> paths;
    Local<V, DiffuseRecord> mattes;
    Local<V, ColourRecord> colours;
    LightUniforms<V> light;
    static constexpr void describe(auto& p, auto&& port) {
      port(NAMED(p.diffuse));
      port(p.points, "places");
      name_all(port, NAMED_ALL(p.paths, p.mattes, p.colours));
      LightUniforms<V>::describe(p.light, port);
    }
  };
  template <class V>
  static void body(const I<V>& item, Ports<V>& io) {
    shade_slot<V>(io.diffuse.load(item).word, AllItems{}, io);
  }
  /// Adds the light of one light source at the surface in ray slot `slot` to its sample if `mask` is true.
  template <class V>
  static void shade_slot(const I<V>& slot, const auto& mask, Ports<V>& io) {
    const PathRecord<V> path = io.paths.load(slot);
    const Vec3<V> light = diffuse_light<V>(io.points.load(slot), path, io.mattes.load(slot).diffuse, io.light).light;
    const M<V> is_lit = and_masks<V>(mask, F<V>(0.0F) < max_channel(light));
    add_light<V>(io.colours, path.sample, select(is_lit, light, Vec3<V>{0.0F, 0.0F, 0.0F}));
  }
};

/// Adds the light of one light source to surfaces whose shadows are already known; replaces the kernel shade_diffuse
/// for interpolated samples. One launch per light.
struct ShadeVisible {
  static constexpr std::string_view kName = "shade_visible";
  static constexpr std::string_view kMeaning =
      "interpolated surface, one light -> its light, unless its shadow is known";
  template <class V>
  struct Ports {
    Local<V, WordRecord> diffuse;
    Local<V, SurfacePointRecord> points;
    Local<V, PathRecord> paths;
    Local<V, DiffuseRecord> mattes;
    Local<V, GeometryRecord> geometry;
    Local<V, ColourRecord> colours;
    I<V> mark;
    LightUniforms<V> light;
    static constexpr void describe(auto& p, auto&& port) {
      port(NAMED(p.diffuse));
      port(p.points, "places");
      name_all(port, NAMED_ALL(p.paths, p.mattes, p.geometry, p.colours, p.mark));
      LightUniforms<V>::describe(p.light, port);
    }
  };
  template <class V>
  static void body(const I<V>& item, Ports<V>& io) {
    shade_slot<V>(io.diffuse.load(item).word, AllItems{}, io);
  }
  /// Adds the light of one light source at the surface in ray slot `slot` to its sample, if `mask` is true and the
  /// surface is not in shadow.
  template <class V>
  static void shade_slot(const I<V>& slot, const auto& mask, Ports<V>& io) {
    const PathRecord<V> path = io.paths.load(slot);
    const Vec3<V> light = diffuse_light<V>(io.points.load(slot), path, io.mattes.load(slot).diffuse, io.light).light;
    const M<V> dark = I<V>(0U) < (io.geometry.load(path.sample).shadows & io.mark);
    const Vec3<V> none{0.0F, 0.0F, 0.0F};
    const Vec3<V> seen = select(and_masks<V>(mask, F<V>(0.0F) < max_channel(light)), light, none);
    add_light<V>(io.colours, path.sample, select(dark, none, seen));
  }
};

struct CombineShadow {
  static constexpr std::string_view kName = "combine_shadow";
  static constexpr std::string_view kMeaning = "shadow ray -> its light into its sample, unless something was hit";
  template <class V>
  struct Ports {
    Local<V, HitRecord> shadow_hits;
    Local<V, PathRecord> shadow_paths;
    Local<V, ColourRecord> colours;
    static constexpr void describe(auto& p, auto&& port) {
      name_all(port, NAMED_ALL(p.shadow_hits, p.shadow_paths, p.colours));
    }
  };
  template <class V>
  static void body(const I<V>& item, Ports<V>& io) {
    const M<V> lit = io.shadow_hits.load(item).triangle == traces::kNoHit;
    const PathRecord<V> path = io.shadow_paths.load(item);
    const Vec3<V> none{0.0F, 0.0F, 0.0F};
    add_light<V>(io.colours, path.sample, select(lit, path.throughput, none));
  }
};

}  // namespace kernels
