#pragma once
#include <limits>
#include <string_view>

#include "shader_kernels/kernels/arithmetic.h"
#include "shader_kernels/kernels/classify.h"
#include "shader_kernels/kernels/effects.h"
#include "shader_kernels/kernels/generate_rays.h"
#include "shader_kernels/kernels/light.h"
#include "shader_kernels/kernels/microfacets.h"
#include "shader_kernels/kernels/pixels.h"
#include "shader_kernels/ports.h"
#include "sim/named.h"
#include "traces/ray.h"

namespace kernels {

// Kernels of the program path:N (docs/paths.md). Random numbers are hashes of the sample's seed, the bounce and a
// dimension. Kernels with kRough are for images with GGX roughness.

/// The dimensions of a bounce: each random number of a path is a hash with another one.
enum class Dimension : std::uint32_t { kLight, kDiscX, kDiscY, kLobe, kRoulette, kDirectionX, kDirectionY };

/// Returns the hash from which the random numbers of a path's bounce follow. `step` identifies the bounce.
template <class V>
I<V> bounce_key(const I<V>& seed, const I<V>& step) {
  return scramble_bits<V>(seed + step);
}
/// Returns a random number in [0, 1) of a bounce.
template <class V>
F<V> random_number(const I<V>& key, Dimension dimension) {
  return hash_to_unit_float<V>(scramble_bits<V>(key + (static_cast<std::uint32_t>(dimension) + 1) * 0x85ebca77U));
}

/// Stores the seed of each sample: a hash of frame, pixel and sample.
struct SeedPaths {
  static constexpr std::string_view kName = "seed_paths";
  static constexpr std::string_view kMeaning = "sample -> seed of its path's random numbers";
  template <class V>
  struct Ports {
    Local<V, WordRecord> seeds;
    TileUniforms<V> tile;
    I<V> image_width, seed;
    static constexpr void describe(auto& p, auto&& port) {
      port(NAMED(p.seeds));
      TileUniforms<V>::describe(p.tile, port);
      name_all(port, NAMED_ALL(p.image_width, p.seed));
    }
  };
  template <class V>
  static void body(const I<V>& item, Ports<V>& io) {
    const SamplePosition<V> s = sample_position<V>(item, io.tile);
    const I<V> pixel = to_int(s.y) * io.image_width + to_int(s.x);
    io.seeds.store(item, {scramble_bits<V>(scramble_bits<V>(pixel ^ io.seed) + to_int(s.number))});
  }
};

/// Sorts the surfaces that light sources illuminate: rough ones, and the other diffuse ones.
struct ClassifyLit {
  static constexpr std::string_view kName = "classify_lit";
  static constexpr std::string_view kMeaning = "surface -> streams diffuse (not rough) and rough";
  template <class V>
  struct Ports {
    Local<V, WordRecord> surfaces;
    Local<V, DiffuseRecord> mattes;
    Local<V, WordRecord> diffuse, rough;
    Counter<V> diffuse_count, rough_count;
    static constexpr void describe(auto& p, auto&& port) {
      name_all(port, NAMED_ALL(p.surfaces, p.mattes, p.diffuse, p.rough, p.diffuse_count, p.rough_count));
    }
  };
  template <class V>
  static void body(const I<V>& item, Ports<V>& io) {
    const I<V> slot = io.surfaces.load(item).word;
    const I<V> classes = io.mattes.load(slot).classes;
    const M<V> is_rough = I<V>(0U) < (classes & traces::kRoughnessMask);
    constexpr std::uint32_t kDiffuseOrRough = traces::kRoughnessMask | traces::kDiffuse;
    const M<V> is_diffuse = (classes & kDiffuseOrRough) == static_cast<std::uint32_t>(traces::kDiffuse);
    io.diffuse.store(io.diffuse_count.next_index(is_diffuse), {slot});
    io.rough.store(io.rough_count.next_index(is_rough), {slot});
  }
};

/// Keeps the surfaces in a list that rays with lower slots than scattered ones have hit. At the others, light sources
/// already represent lamps.
struct KeepVisible {
  static constexpr std::string_view kName = "keep_visible";
  static constexpr std::string_view kMeaning = "surface -> the same stream, unless a scattered ray hit it";
  template <class V>
  struct Ports {
    Local<V, WordRecord> stream, kept;
    Counter<V> kept_count;
    I<V> scattered;  ///< first ray slot of scattered rays
    static constexpr void describe(auto& p, auto&& port) {
      port(NAMED(p.stream));
      port(p.kept, "visible_emitters");
      name_all(port, NAMED_ALL(p.kept_count, p.scattered));
    }
  };
  template <class V>
  static void body(const I<V>& item, Ports<V>& io) {
    const I<V> slot = io.stream.load(item).word;
    io.kept.store(io.kept_count.next_index(slot < io.scattered), {slot});
  }
};

template <class V, bool kSoft>
struct SampleLightPorts {
  Local<V, WordRecord> stream, seeds;
  Local<V, SurfacePointRecord> points;
  Local<V, PathRecord> paths;
  Local<V, DiffuseRecord> mattes;
  Table<V, LightUniforms> light_table;
  Table<V, DiscUniforms> disc_table;  ///< discs of the lights; only in kSoft variants
  Local<V, RayRecord> shadow_rays;
  Local<V, PathRecord> shadow_paths;
  Counter<V> emitted;
  F<V> light_count, epsilon;
  I<V> step;
  static constexpr void describe(auto& p, auto&& port) {
    name_all(port, NAMED_ALL(p.stream, p.seeds));
    port(p.points, "places");
    name_all(port, NAMED_ALL(p.paths, p.mattes, p.light_table));
    if constexpr (kSoft) port(NAMED(p.disc_table));
    name_all(port, NAMED_ALL(p.shadow_rays, p.shadow_paths, p.emitted, p.light_count, p.epsilon, p.step));
  }
};

/// A light source that a surface has chosen at random.
template <class V>
struct ChosenLight {
  I<V> number, key;
  LightUniforms<V> light;
  SeenLight<V> seen;
};
template <class V>
ChosenLight<V> choose_light(const SurfacePointRecord<V>& point, const I<V>& sample, const auto& io) {
  const I<V> key = bounce_key<V>(io.seeds.load(sample).word, io.step);
  const F<V> at = floor(random_number<V>(key, Dimension::kLight) * io.light_count);
  const I<V> number = to_int(min(at, io.light_count - 1.0F));
  const LightUniforms<V> light = io.light_table.load(number);
  return {number, key, light, see_light<V>(point, light)};
}

/// Emits a shadow ray to a chosen light. `scattered`: fraction of the light that the surface scatters to the eye.
template <class V, bool kSoft>
void emit_light_ray(SampleLightPorts<V, kSoft>& io, const SurfacePointRecord<V>& point, const PathRecord<V>& path,
                    const ChosenLight<V>& chosen, const Vec3<V>& scattered) {
  const SeenLight<V>& seen = chosen.seen;
  const Vec3<V> light =
      path.throughput * scattered * (chosen.light.intensity * (max(seen.share, F<V>(0.0F)) * io.light_count));
  const I<V> out = io.emitted.next_index(F<V>(0.0F) < max_channel(light));
  const F<V> t_min = io.epsilon * seen.inverse_distance;
  if constexpr (kSoft) {
    const DiscUniforms<V> disc = io.disc_table.load(chosen.number);
    const UnitPoint<V> aim = map_to_disc<V>(
        {random_number<V>(chosen.key, Dimension::kDiscX), random_number<V>(chosen.key, Dimension::kDiscY)});
    const Vec3<V> direction = seen.to_light + disc.across_x * aim.x + disc.across_y * aim.y;
    const F<V> before = max(disc.radius * seen.inverse_distance, t_min);
    io.shadow_rays.store(out, {point.position, t_min, direction, chosen.light.reach - before});
  } else {
    io.shadow_rays.store(out, {point.position, t_min, seen.to_light, chosen.light.reach - t_min});
  }
  io.shadow_paths.store(out, {light, path.sample});
}

/// Next-event estimation at diffuse surfaces: emits one shadow ray to one light, chosen by hash with equal
/// probabilities.
template <bool kSoft>
struct SampleLight {
  static constexpr std::string_view kName = kSoft ? "sample_light_soft" : "sample_light";
  static constexpr std::string_view kMeaning = kSoft ? "as sample_light, to a random point of the light's disc"
                                                     : "diffuse surface -> shadow ray to one light, chosen at random";
  template <class V>
  using Ports = SampleLightPorts<V, kSoft>;
  template <class V>
  static void body(const I<V>& item, Ports<V>& io) {
    const I<V> slot = io.stream.load(item).word;
    const SurfacePointRecord<V> point = io.points.load(slot);
    const PathRecord<V> path = io.paths.load(slot);
    const ChosenLight<V> chosen = choose_light<V>(point, path.sample, io);
    emit_light_ray<V, kSoft>(io, point, path, chosen, io.mattes.load(slot).diffuse);
  }
};

/// Next-event estimation at rough surfaces: as sample_light, with the sum of the diffuse and the GGX lobe.
template <bool kSoft>
struct SampleLightRough {
  static constexpr std::string_view kName = kSoft ? "sample_light_rough_soft" : "sample_light_rough";
  static constexpr std::string_view kMeaning = kSoft ? "as sample_light_rough, to a random point of the light's disc"
                                                     : "rough surface -> shadow ray to one light, chosen at random";
  template <class V>
  struct Ports : SampleLightPorts<V, kSoft> {
    Local<V, RayRecord> rays;
    Local<V, SpecularRecord> optics;
    static constexpr void describe(auto& p, auto&& port) {
      SampleLightPorts<V, kSoft>::describe(p, port);
      name_all(port, NAMED_ALL(p.rays, p.optics));
    }
  };
  template <class V>
  static void body(const I<V>& item, Ports<V>& io) {
    const I<V> slot = io.stream.load(item).word;
    const SurfacePointRecord<V> point = io.points.load(slot);
    const PathRecord<V> path = io.paths.load(slot);
    const DiffuseRecord<V> matte = io.mattes.load(slot);
    const Vec3<V> direction = io.rays.load(slot).direction;
    const ChosenLight<V> chosen = choose_light<V>(point, path.sample, io);
    const SpecularRecord<V> optics = io.optics.load(slot);
    const F<V> from_eye = -dot(direction, point.normal);
    const Vec3<V> facets = scatter_by_facets<V>(direction, chosen.seen.to_light * chosen.seen.inverse_distance,
                                                point.normal, max(from_eye, F<V>(kGrazing)), chosen.seen.cosine,
                                                optics.mirrored, optics.kept, alpha_of<V>(matte.classes));
    const Vec3<V> scattered = matte.diffuse * (1.0F - schlick_share<V>(from_eye)) + facets;
    emit_light_ray<V, kSoft>(io, point, path, chosen, scattered);
  }
};

/// Chooses by hash how each path continues, with probabilities in proportion to the light of each lobe, and plays
/// Russian roulette. Divides the path's throughput by the probability of the outcome. The list of the chosen lobe gets
/// the path: straight through a blended surface, mirrored, rough, refracted or diffuse.
template <bool kRough>
struct ChooseLobe {
  static constexpr std::string_view kName = kRough ? "choose_lobe_rough" : "choose_lobe";
  static constexpr std::string_view kMeaning =
      kRough ? "as choose_lobe, with rough surfaces"
             : "surface -> stream diffuse, mirror, glass or blended, one chosen at random, or none";
  template <class V>
  struct Ports {
    Local<V, WordRecord> surfaces, seeds;
    Local<V, SurfacePointRecord> points;
    Local<V, RayRecord> rays;
    Local<V, PathRecord> paths;
    Local<V, DiffuseRecord> mattes;
    Local<V, SpecularRecord> optics;
    Local<V, WordRecord> diffuse, mirror, glass, blended;
    Local<V, WordRecord> rough;  ///< only in kRough variants
    Counter<V> diffuse_count, mirror_count, glass_count, blended_count, rough_count;
    F<V> least_survival;  ///< smallest probability of survival; 1: no roulette
    I<V> step;
    static constexpr void describe(auto& p, auto&& port) {
      name_all(port, NAMED_ALL(p.surfaces, p.seeds));
      port(p.points, "places");
      name_all(port, NAMED_ALL(p.rays, p.paths, p.mattes, p.optics, p.diffuse, p.mirror, p.glass, p.blended));
      if constexpr (kRough) port(NAMED(p.rough));
      name_all(port, NAMED_ALL(p.diffuse_count, p.mirror_count, p.glass_count, p.blended_count));
      if constexpr (kRough) port(NAMED(p.rough_count));
      name_all(port, NAMED_ALL(p.least_survival, p.step));
    }
  };
  template <class V>
  static void body(const I<V>& item, Ports<V>& io) {
    const I<V> slot = io.surfaces.load(item).word;
    const SurfacePointRecord<V> point = io.points.load(slot);
    const Vec3<V> direction = io.rays.load(slot).direction;
    const PathRecord<V> path = io.paths.load(slot);
    const DiffuseRecord<V> matte = io.mattes.load(slot);
    const SpecularRecord<V> optics = io.optics.load(slot);
    const I<V> key = bounce_key<V>(io.seeds.load(path.sample).word, io.step);
    const Interface<V> glass = make_interface<V>(direction, point.normal, point.side, optics.ior);

    // The light of each lobe, in the path's largest channel.
    const F<V> reflected = optics.entering * glass.reflectance;
    Vec3<V> mirrored = optics.mirrored + Vec3<V>{reflected, reflected, reflected};
    Vec3<V> diffuse = matte.diffuse;
    const I<V> roughness = matte.classes & traces::kRoughnessMask;
    if constexpr (kRough) {
      const M<V> is_rough = I<V>(0U) < roughness;
      const F<V> share = select(is_rough, schlick_share<V>(glass.cosine), F<V>(0.0F));
      mirrored = mirrored + (Vec3<V>{optics.kept, optics.kept, optics.kept} - mirrored) * share;
      diffuse = diffuse * (1.0F - share);
    }
    const F<V> straight = max_channel(path.throughput) * (1.0F - optics.kept);
    const F<V> mirror = straight + max_channel(path.throughput * mirrored);
    const F<V> refracted =
        mirror + max_channel(path.throughput * (optics.tint * (optics.entering * (1.0F - glass.reflectance))));
    const F<V> all = refracted + max_channel(path.throughput * diffuse);

    const F<V> at = random_number<V>(key, Dimension::kLobe) * all;
    const M<V> below_straight = at < straight, below_mirror = at < mirror, below_refracted = at < refracted;
    const F<V> weight =
        select(below_straight, straight,
               select(below_mirror, mirror - straight, select(below_refracted, refracted - mirror, all - refracted)));
    // `all` is the throughput after division by the probability weight / all, so that it also is the roulette's.
    const F<V> survival = min(max(all, io.least_survival), F<V>(1.0F));
    const M<V> survives = logical_and(random_number<V>(key, Dimension::kRoulette) < survival, F<V>(0.0F) < weight);
    io.paths.store(slot, {path.throughput * (all / max(weight * survival, F<V>(1e-30F))), path.sample});

    const auto append = [&](const M<V>& mask, const Local<V, WordRecord>& list, Counter<V>& count) {
      list.store(count.next_index(logical_and(survives, mask)), {slot});
    };
    const M<V> is_mirror = logical_and(straight <= at, below_mirror);
    append(below_straight, io.blended, io.blended_count);
    if constexpr (kRough) {
      append(logical_and(is_mirror, I<V>(0U) < roughness), io.rough, io.rough_count);
      append(logical_and(is_mirror, roughness == 0U), io.mirror, io.mirror_count);
    } else {
      append(is_mirror, io.mirror, io.mirror_count);
    }
    append(logical_and(mirror <= at, below_refracted), io.glass, io.glass_count);
    append(refracted <= at, io.diffuse, io.diffuse_count);
  }
};

template <class V>
struct ScatterPorts {
  Local<V, WordRecord> stream, seeds;
  Local<V, SurfacePointRecord> points;
  Local<V, PathRecord> paths;
  Local<V, DiffuseRecord> mattes;
  Local<V, RayRecord> next_rays;
  Local<V, PathRecord> next_paths;
  Counter<V> emitted;
  F<V> epsilon;
  I<V> step;
  static constexpr void describe(auto& p, auto&& port) {
    name_all(port, NAMED_ALL(p.stream, p.seeds));
    port(p.points, "places");
    name_all(port, NAMED_ALL(p.paths, p.mattes, p.next_rays, p.next_paths, p.emitted, p.epsilon, p.step));
  }
  /// Emits the next ray of a path unless its throughput is 0.
  void emit_ray(const Vec3<V>& origin, const Vec3<V>& direction, const PathRecord<V>& path) {
    const I<V> out = emitted.next_index(F<V>(0.0F) < max_channel(path.throughput));
    next_rays.store(out, {origin, epsilon, direction, std::numeric_limits<float>::infinity()});
    next_paths.store(out, path);
  }
};

/// Emits the next ray of paths that continue diffusely, with a cosine-distributed direction.
template <bool kRough>
struct ScatterDiffuse {
  static constexpr std::string_view kName = kRough ? "scatter_diffuse_rough" : "scatter_diffuse";
  static constexpr std::string_view kMeaning = kRough ? "as scatter_diffuse, dimmed by the reflection of rough surfaces"
                                                      : "diffuse surface -> ray in a random direction";
  template <class V>
  struct Ports : ScatterPorts<V> {
    Local<V, RayRecord> rays;  ///< only in kRough variants
    static constexpr void describe(auto& p, auto&& port) {
      ScatterPorts<V>::describe(p, port);
      if constexpr (kRough) port(NAMED(p.rays));
    }
  };
  template <class V>
  static void body(const I<V>& item, Ports<V>& io) {
    const I<V> slot = io.stream.load(item).word;
    const SurfacePointRecord<V> point = io.points.load(slot);
    const PathRecord<V> path = io.paths.load(slot);
    const DiffuseRecord<V> matte = io.mattes.load(slot);
    const I<V> key = bounce_key<V>(io.seeds.load(path.sample).word, io.step);
    const F<V> squared_radius = random_number<V>(key, Dimension::kDirectionY);
    const UnitPoint<V> disc = circle_point<V>(random_number<V>(key, Dimension::kDirectionX), sqrt(squared_radius));
    const PerpendicularAxes<V> to_side = perpendicular_axes<V>(point.normal);
    const Vec3<V> direction =
        unit_vector(to_side.x * disc.x + to_side.y * disc.y + point.normal * sqrt(1.0F - squared_radius));
    Vec3<V> diffuse = matte.diffuse;
    if constexpr (kRough) {
      const F<V> cosine = -dot(io.rays.load(slot).direction, point.normal);
      const M<V> is_rough = I<V>(0U) < (matte.classes & traces::kRoughnessMask);
      diffuse = diffuse * (1.0F - select(is_rough, schlick_share<V>(cosine), F<V>(0.0F)));
    }
    io.emit_ray(point.position, direction, {path.throughput * diffuse, path.sample});
  }
};

/// Emits the next ray of paths that a rough surface reflects. The microfacet is chosen among those that the ray sees.
struct ScatterRough {
  static constexpr std::string_view kName = "scatter_rough";
  static constexpr std::string_view kMeaning = "rough surface -> ray reflected by a random microfacet (GGX)";
  template <class V>
  struct Ports : ScatterPorts<V> {
    Local<V, RayRecord> rays;
    Local<V, SpecularRecord> optics;
    static constexpr void describe(auto& p, auto&& port) {
      ScatterPorts<V>::describe(p, port);
      name_all(port, NAMED_ALL(p.rays, p.optics));
    }
  };
  template <class V>
  static void body(const I<V>& item, Ports<V>& io) {
    const I<V> slot = io.stream.load(item).word;
    const SurfacePointRecord<V> point = io.points.load(slot);
    const PathRecord<V> path = io.paths.load(slot);
    const Vec3<V> direction = io.rays.load(slot).direction;
    const I<V> key = bounce_key<V>(io.seeds.load(path.sample).word, io.step);
    const UnitPoint<V> square{random_number<V>(key, Dimension::kDirectionX),
                              random_number<V>(key, Dimension::kDirectionY)};
    const SpecularRecord<V> optics = io.optics.load(slot);
    const FacetReflection<V> ray = reflect_by_facet<V>(direction, point.normal, square, optics.mirrored, optics.kept,
                                                       alpha_of<V>(io.mattes.load(slot).classes));
    io.emit_ray(point.position, ray.direction, {path.throughput * ray.weight, path.sample});
  }
};

/// Averages the samples of a pixel. Only the mean is clamped, because the samples of a path tracer are noisy.
struct AveragePaths {
  static constexpr std::string_view kName = "average_paths";
  static constexpr std::string_view kMeaning = "sample -> mean of its pixel's samples, only the mean clamped";
  template <class V>
  using Ports = AverageColour::Ports<V>;
  template <class V>
  static void body(const I<V>& item, Ports<V>& io) {
    const DivMod<V> pixel = div_mod<V>(to_float(item), io.samples, io.inverse_samples);
    const M<V> first = pixel.remainder <= 0.0F;
    const Vec3<V> colour = io.colours.load(item).rgb;
    const auto mean = [&](LoopCarried<V>& so_far, const F<V>& sample) {
      const F<V> next = select(first, F<V>(0.0F), so_far.get()) + sample;
      so_far.set(next);
      return clamp_to_unit<V>(next * io.inverse_samples);
    };
    const F<V> red = mean(io.red, colour.x), green = mean(io.green, colour.y), blue = mean(io.blue, colour.z);
    io.pixels.store(to_int(pixel.quotient), {{red, green, blue}});
  }
};

}  // namespace kernels
