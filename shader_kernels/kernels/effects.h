#pragma once
#include <array>
#include <limits>
#include <string_view>

#include "shader_kernels/kernels/arithmetic.h"
#include "shader_kernels/kernels/light.h"
#include "shader_kernels/kernels/reconstruct.h"
#include "shader_kernels/kernels/uniforms.h"
#include "shader_kernels/ports.h"
#include "shader_kernels/value.h"
#include "sim/named.h"
#include "traces/ray.h"

namespace kernels {

/// Uniforms from which a launch computes a random point in the unit square; each ray of an effect has its own launch.
/// The rays of one surface cover the square evenly; a hash shifts their pattern from surface to surface.
template <class V>
struct RandomPointUniforms {
  F<V> x, y;  ///< point in the unit square of this launch's ray, before the hash shifts it
  I<V> seed;  ///< seed of the hash; differs between frames and between effects
  static constexpr void describe(auto& d, auto&& port) {
    port(d.x, "draw.x");
    port(d.y, "draw.y");
    port(d.seed, "draw.seed");
  }
};

template <class V>
struct UnitPoint {
  F<V> x, y;
};

/// Returns the random point in the unit square for one ray of an effect. `hit_direction`: direction of the ray that hit
/// the surface. This direction is the hash key, because its bits do not depend on tile size, order and tracer.
template <class V>
UnitPoint<V> random_point_in_square(const Vec3<V>& hit_direction, const RandomPointUniforms<V>& draw) {
  const I<V> key = (bits_of(hit_direction.x) * 0x9e3779b1U) ^ (bits_of(hit_direction.y) * 0x85ebca77U) ^
                   (bits_of(hit_direction.z) * 0xc2b2ae3dU) ^ draw.seed;
  const I<V> first = scramble_bits<V>(key);
  const F<V> x = hash_to_unit_float<V>(first) + draw.x;
  const F<V> y = hash_to_unit_float<V>(scramble_bits<V>(first ^ 0x9e3779b9U)) + draw.y;
  return {x - floor(x), y - floor(y)};
}

/// Returns the sine of an angle in half turns, -1 to 1, approximated by two parabolas. The error is below 0.0012.
template <class V>
F<V> sin_half_turns(const F<V>& half_turns) {
  const F<V> arch = half_turns * 4.0F * (1.0F - abs(half_turns));
  return arch * (abs(arch) * 0.225F + 0.775F);
}

/// Maps a point of the unit square to the unit disc with uniform density. `x` gives the angle, `y` the squared radius.
template <class V>
UnitPoint<V> map_to_disc(const UnitPoint<V>& square) {
  const F<V> half_turns = square.x * 2.0F - 1.0F;
  const F<V> quarter_on = half_turns + 0.5F;
  const F<V> radius = sqrt(square.y);
  return {radius * sin_half_turns<V>(select(quarter_on < 1.0F, quarter_on, quarter_on - 2.0F)),
          radius * sin_half_turns<V>(half_turns)};
}

/// Two unit vectors that are perpendicular to a given unit vector and to each other (Duff et al. 2017).
template <class V>
struct PerpendicularAxes {
  Vec3<V> x, y;
};
template <class V>
PerpendicularAxes<V> perpendicular_axes(const Vec3<V>& normal) {
  const F<V> sign = select(normal.z < 0.0F, F<V>(-1.0F), F<V>(1.0F));
  const F<V> a = -1.0F / (sign + normal.z);
  const F<V> b = normal.x * normal.y * a;
  const F<V> x = sign * normal.x;
  return {{1.0F + x * normal.x * a, sign * b, -x}, {b, sign + normal.y * normal.y * a, -normal.y}};
}

/// A light source as a disc that faces the surface, and the fraction of the light that one ray carries.
template <class V>
struct DiscUniforms {
  Vec3<V> across_x, across_y;  ///< axes of the disc; their length is the radius of the light source
  F<V> radius, share;
  static constexpr void describe(auto& d, auto&& port) {
    port(d.across_x, "disc.across_x");
    port(d.across_y, "disc.across_y");
    port(d.radius, "disc.radius");
    port(d.share, "disc.share");
  }
  static void fields(auto& d, auto&& field) { name_all(field, NAMED_ALL(d.across_x, d.across_y, d.radius, d.share)); }
};

template <class V>
struct ShadeDiscPorts : ShadeDiffuse::Ports<V> {
  Local<V, RayRecord> rays;
  DiscUniforms<V> disc;
  RandomPointUniforms<V> draw;
  static constexpr void describe(auto& p, auto&& port) {
    ShadeDiffuse::Ports<V>::describe(p, port);
    port(NAMED(p.rays));
    DiscUniforms<V>::describe(p.disc, port);
    RandomPointUniforms<V>::describe(p.draw, port);
  }
};

/// Emits soft-shadow rays, with one launch per light and ray; replaces the kernel shade_diffuse. A ray goes to a point
/// of the light's disc and ends one radius before it, so that the lamp's own geometry cannot block the ray. The light
/// is computed for the disc's centre. With kShareAlone a ray carries only a weight, 1 / number of rays, instead of
/// light.
template <bool kShareAlone>
struct ShadeDisc {
  static constexpr std::string_view kName = kShareAlone ? "shade_soft_share" : "shade_soft";
  static constexpr std::string_view kMeaning =
      kShareAlone ? "diffuse surface, one light -> shadow ray to a point of it, with its share"
                  : "diffuse surface, one light -> shadow ray to a point of it, with a share of its light";
  template <class V>
  using Ports = ShadeDiscPorts<V>;
  template <class V>
  static void body(const I<V>& item, Ports<V>& io) {
    shade_slot<V>(io.diffuse.load(item).word, AllItems{}, io);
  }
  /// Emits a soft-shadow ray from the surface in ray slot `slot` if `mask` is true.
  template <class V>
  static void shade_slot(const I<V>& slot, const auto& mask, Ports<V>& io) {
    const SurfacePointRecord<V> point = io.points.load(slot);
    const PathRecord<V> path = io.paths.load(slot);
    const auto [to_light, inverse_distance, light] =
        diffuse_light<V>(point, path, io.mattes.load(slot).diffuse, io.light);
    const UnitPoint<V> aim = map_to_disc<V>(random_point_in_square<V>(io.rays.load(slot).direction, io.draw));
    const Vec3<V> direction = to_light + io.disc.across_x * aim.x + io.disc.across_y * aim.y;

    const I<V> out = io.emitted.next_index(and_masks<V>(mask, F<V>(0.0F) < max_channel(light)));
    const F<V> t_min = io.epsilon * inverse_distance;
    const F<V> before = max(io.disc.radius * inverse_distance, t_min);
    io.shadow_rays.store(out, {point.position, t_min, direction, io.light.reach - before});
    const F<V>& share = io.disc.share;
    if constexpr (kShareAlone) {
      io.shadow_paths.store(out, {{share, share, share}, path.sample});
    } else {
      io.shadow_paths.store(out, {light * share, path.sample});
    }
  }
};
using ShadeSoft = ShadeDisc<false>;
using ShadeSoftShare = ShadeDisc<true>;

template <class V>
struct CastAmbientPorts {
  Local<V, WordRecord> diffuse;
  Local<V, SurfacePointRecord> points;
  Local<V, RayRecord> rays;
  Local<V, PathRecord> paths;
  Local<V, DiffuseRecord> mattes;
  Local<V, RayRecord> shadow_rays;
  Local<V, PathRecord> shadow_paths;
  Counter<V> emitted;
  Vec3<V> ambient;  ///< ambient light that one occlusion ray carries
  F<V> epsilon, distance;
  RandomPointUniforms<V> draw;
  static constexpr void describe(auto& p, auto&& port) {
    port(NAMED(p.diffuse));
    port(p.points, "places");
    name_all(port, NAMED_ALL(p.rays, p.paths, p.mattes, p.shadow_rays, p.shadow_paths, p.emitted, p.ambient, p.epsilon,
                             p.distance));
    RandomPointUniforms<V>::describe(p.draw, port);
  }
};

/// Emits ambient-occlusion rays, with one launch per ray of a surface; replaces the kernel shade_ambient. Directions
/// are cosine-distributed, so all rays have the same weight. With kShareAlone a ray carries only a weight, 1 / number
/// of rays, instead of light.
template <bool kShareAlone>
struct CastAmbient {
  static constexpr std::string_view kName = kShareAlone ? "cast_occlusion_share" : "cast_occlusion";
  static constexpr std::string_view kMeaning = kShareAlone
                                                   ? "diffuse surface -> ray that brings its share of ambient light"
                                                   : "diffuse surface -> ray that brings a share of its ambient light";
  template <class V>
  struct Ports : CastAmbientPorts<V> {
    F<V> share;  ///< weight that one ray carries, 1 / number of rays; used only if kShareAlone
    static constexpr void describe(auto& p, auto&& port) {
      CastAmbientPorts<V>::describe(p, port);
      if constexpr (kShareAlone) port(NAMED(p.share));
    }
  };
  template <class V>
  static void body(const I<V>& item, Ports<V>& io) {
    shade_slot<V>(io.diffuse.load(item).word, AllItems{}, io);
  }
  /// Emits an occlusion ray from the surface in ray slot `slot` if `mask` is true.
  template <class V>
  static void shade_slot(const I<V>& slot, const auto& mask, Ports<V>& io) {
    const SurfacePointRecord<V> point = io.points.load(slot);
    const PathRecord<V> path = io.paths.load(slot);
    const Vec3<V> light = path.throughput * io.mattes.load(slot).diffuse * io.ambient;
    const UnitPoint<V> square = random_point_in_square<V>(io.rays.load(slot).direction, io.draw);
    const UnitPoint<V> disc = map_to_disc<V>(square);
    const PerpendicularAxes<V> to_side = perpendicular_axes<V>(point.normal);
    const Vec3<V> direction = to_side.x * disc.x + to_side.y * disc.y + point.normal * sqrt(1.0F - square.y);

    const I<V> out = io.emitted.next_index(and_masks<V>(mask, F<V>(0.0F) < max_channel(light)));
    io.shadow_rays.store(out, {point.position, io.epsilon, direction, io.distance});
    if constexpr (kShareAlone) {
      io.shadow_paths.store(out, {{io.share, io.share, io.share}, path.sample});
    } else {
      io.shadow_paths.store(out, {light, path.sample});
    }
  }
};
using CastOcclusion = CastAmbient<false>;
using CastOcclusionShare = CastAmbient<true>;

// Effects at a lower rate than primary rays (docs/design/effects.md): only one pixel of 2 x 2, or every other pixel of
// a checkerboard, emits effect rays. The other pixels average the visible fraction of a light over the pixels around
// them.

/// Returns a word that is not 0 if the pixel at (x, y) emits no effect rays (effects at only some pixels).
template <class V, bool kCheckerboard>
I<V> effect_ray_skip_word(const I<V>& x, const I<V>& y) {
  return (kCheckerboard ? x ^ y : x | y) & 1U;
}

/// Lists the samples that emit effect rays, if effects such as occlusion are traced at only some pixels. The tile
/// buffer then has one sample per pixel.
template <bool kCheckerboard>
struct SelectEffects {
  static constexpr std::string_view kName = kCheckerboard ? "select_effects_checkerboard" : "select_effects";
  static constexpr std::string_view kMeaning =
      kCheckerboard ? "diffuse surface -> stream of those of every other pixel, as on a checkerboard"
                    : "diffuse surface -> stream of those of one of 2 x 2 pixels";
  template <class V>
  struct Ports {
    Local<V, WordRecord> diffuse;
    Local<V, PathRecord> paths;
    Local<V, WordRecord> passed;
    Counter<V> passed_count;
    GridUniforms<V> grid;
    static constexpr void describe(auto& p, auto&& port) {
      name_all(port, NAMED_ALL(p.diffuse, p.paths, p.passed, p.passed_count));
      GridUniforms<V>::describe(p.grid, port);
    }
  };
  template <class V>
  static void body(const I<V>& item, Ports<V>& io) {
    const I<V> slot = io.diffuse.load(item).word;
    const DivMod<V> pixel = div_mod<V>(to_float(io.paths.load(slot).sample), io.grid.pitch, io.grid.inverse_pitch);
    const I<V> left_out = effect_ray_skip_word<V, kCheckerboard>(to_int(io.grid.x0 + pixel.remainder),
                                                                 to_int(io.grid.y0 + pixel.quotient));
    io.passed.store(io.passed_count.next_index(left_out == 0U), {slot});
  }
};

/// Clears a sample's stored light and visible fraction of one light source, before the effect rays to this light source
/// are traced. One launch per light source.
struct ClearEffects {
  static constexpr std::string_view kName = "clear_effects";
  static constexpr std::string_view kMeaning = "sample -> no light whose share is to be found, nothing found of it";
  template <class V>
  struct Ports {
    Local<V, ColourRecord> lights;
    Local<V, RatioRecord> ratios;
    LatticeUniforms<V> lattice;
    static constexpr void describe(auto& p, auto&& port) {
      name_all(port, NAMED_ALL(p.lights, p.ratios));
      LatticeUniforms<V>::describe(p.lattice, port);
    }
  };
  template <class V>
  static void body(const I<V>& item, Ports<V>& io) {
    const I<V> sample = lattice_sample<V>(item, io.lattice);
    const Vec3<V> none{0.0F, 0.0F, 0.0F};
    io.lights.store(sample, {none});
    io.ratios.store(sample, {none, 0.0F});
  }
};

/// Adds the weight of an effect ray (for soft shadows or occlusion) to the visible fraction of the light source, stored
/// for the ray's sample. Adds nothing if the ray was blocked.
struct CombineRatio {
  static constexpr std::string_view kName = "combine_ratio";
  static constexpr std::string_view kMeaning =
      "ray for a share of light -> that into its sample's, unless it was stopped";
  template <class V>
  struct Ports {
    Local<V, HitRecord> shadow_hits;
    Local<V, PathRecord> shadow_paths;
    Local<V, RatioRecord> ratios;
    F<V> share;
    static constexpr void describe(auto& p, auto&& port) {
      name_all(port, NAMED_ALL(p.shadow_hits, p.shadow_paths, p.ratios, p.share));
    }
  };
  template <class V>
  static void body(const I<V>& item, Ports<V>& io) {
    const M<V> lit = io.shadow_hits.load(item).triangle == traces::kNoHit;
    const PathRecord<V> path = io.shadow_paths.load(item);
    const RatioRecord<V> so_far = io.ratios.load(path.sample);
    const Vec3<V> brought = select(lit, path.throughput, Vec3<V>{0.0F, 0.0F, 0.0F});
    io.ratios.store(path.sample, {so_far.rgb + brought, so_far.found + io.share});
  }
};

/// Emits a diffuse ray from a selected surface. The light that it finds is added to another colour of the sample.
struct CastBounce {
  static constexpr std::string_view kName = "cast_bounce";
  static constexpr std::string_view kMeaning = "diffuse surface -> ray that brings the light of other surfaces";
  template <class V>
  struct Ports {
    Local<V, WordRecord> stream;
    Local<V, SurfacePointRecord> points;
    Local<V, RayRecord> rays;
    Local<V, PathRecord> paths;
    Local<V, RatioRecord> ratios;
    Local<V, ColourRecord> colours;
    Local<V, RayRecord> next_rays;
    Local<V, PathRecord> next_paths;
    Counter<V> emitted;
    F<V> epsilon;
    I<V> apart;  ///< index offset from a sample to the sample that collects the light
    RandomPointUniforms<V> draw;
    static constexpr void describe(auto& p, auto&& port) {
      port(NAMED(p.stream));
      port(p.points, "places");
      name_all(port, NAMED_ALL(p.rays, p.paths, p.ratios, p.colours, p.next_rays, p.next_paths, p.emitted, p.epsilon,
                               p.apart));
      RandomPointUniforms<V>::describe(p.draw, port);
    }
  };
  template <class V>
  static void body(const I<V>& item, Ports<V>& io) {
    const I<V> slot = io.stream.load(item).word;
    const SurfacePointRecord<V> point = io.points.load(slot);
    const PathRecord<V> path = io.paths.load(slot);
    const UnitPoint<V> square = random_point_in_square<V>(io.rays.load(slot).direction, io.draw);
    const UnitPoint<V> disc = map_to_disc<V>(square);
    const PerpendicularAxes<V> to_side = perpendicular_axes<V>(point.normal);
    const Vec3<V> direction =
        unit_vector(to_side.x * disc.x + to_side.y * disc.y + point.normal * sqrt(1.0F - square.y));
    const I<V> collector = path.sample + io.apart;
    const I<V> out = io.emitted.next_index(F<V>(0.0F) <= square.y);
    io.next_rays.store(out, {point.position, io.epsilon, direction, std::numeric_limits<float>::infinity()});
    io.next_paths.store(out, {{1.0F, 1.0F, 1.0F}, collector});
    io.colours.store(collector, {{0.0F, 0.0F, 0.0F}});
    io.ratios.store(path.sample, {{0.0F, 0.0F, 0.0F}, 1.0F});
  }
};

/// Stores the light that a sample's diffuse ray found as the visible fraction of a white sky.
struct TakeBounce {
  static constexpr std::string_view kName = "take_bounce";
  static constexpr std::string_view kMeaning = "sample -> light of its diffuse ray, if it emitted one, as a share";
  template <class V>
  struct Ports {
    Local<V, ColourRecord> colours;
    Local<V, RatioRecord> ratios;
    LatticeUniforms<V> lattice;
    I<V> apart;
    static constexpr void describe(auto& p, auto&& port) {
      name_all(port, NAMED_ALL(p.colours, p.ratios));
      LatticeUniforms<V>::describe(p.lattice, port);
      port(NAMED(p.apart));
    }
  };
  template <class V>
  static void body(const I<V>& item, Ports<V>& io) {
    const I<V> sample = lattice_sample<V>(item, io.lattice);
    const F<V> found = io.ratios.load(sample).found;
    const Vec3<V> light = io.colours.load(sample + io.apart).rgb;
    io.ratios.store(sample, {select(F<V>(0.0F) < found, light, Vec3<V>{0.0F, 0.0F, 0.0F}), found});
  }
};

/// Filter weight of a pixel that is not similar to the filtered pixel. It is so small that it matters only if no pixel
/// is similar.
inline constexpr float kUnlikeWeight = 1e-4F;

/// Adds the light of one light source to all pixels whose final colours a tile computes. A pixel that emitted no rays
/// uses the mean visible fraction of up to four neighbours that did, weighted by the similarity measure of the program
/// reconstruct.
template <bool kCheckerboard>
struct UpsampleEffects {
  static constexpr std::string_view kName = kCheckerboard ? "upsample_effects_checkerboard" : "upsample_effects";
  static constexpr std::string_view kMeaning =
      kCheckerboard ? "finished pixel, one light -> its light, by its own share or that of pixels beside it"
                    : "finished pixel, one light -> its light, by its own share or that of pixels around it";
  template <class V>
  struct Ports {
    FinishedUniforms<V> finished;
    Local<V, VisibleRecord> visible;
    Local<V, ColourRecord> lights;
    Local<V, RatioRecord> ratios;
    Local<V, ColourRecord> colours;
    F<V> x0, y0;  ///< picture position of the first pixel whose final colour the tile computes
    F<V> bend;
    I<V> apart;  ///< index offset of the records that belong to this light source
    static constexpr void describe(auto& p, auto&& port) {
      FinishedUniforms<V>::describe(p.finished, port);
      name_all(port, NAMED_ALL(p.visible, p.lights, p.ratios, p.colours, p.x0, p.y0, p.bend, p.apart));
    }
  };
  template <class V>
  static void body(const I<V>& item, Ports<V>& io) {
    const DivMod<V> pixel = row_and_column<V>(to_float(item), io.finished);
    const F<V> centre = centre_sample<V>(pixel, io.finished);
    const I<V> sample = to_int(centre);
    const VisibleRecord<V> own = io.visible.load(sample);
    const I<V> of_light = sample + io.apart;
    const RatioRecord<V> found = io.ratios.load(of_light);
    const RatioRecord<V> around = sum_neighbour_ratios<V>(pixel, centre, own, io);
    const M<V> is_found = F<V>(0.0F) < found.found;
    const M<V> is_known = F<V>(0.0F) < around.found;
    const F<V> inverse = 1.0F / select(is_known, around.found, F<V>(1.0F));
    const Vec3<V> filtered = select(is_known, around.rgb * inverse, Vec3<V>{1.0F, 1.0F, 1.0F});
    add_light<V>(io.colours, sample, io.lights.load(of_light).rgb * select(is_found, found.rgb, filtered));
  }

 private:
  /// Index offset, in samples, from a pixel to another pixel of its row or column; 0 if that pixel is outside the
  /// picture.
  template <class V>
  struct Step {
    F<V> samples;
    M<V> inside;
  };
  template <class V>
  static Step<V> step_inside_picture(const F<V>& from, const F<V>& by, const F<V>& samples, const F<V>& low,
                                     const F<V>& high) {
    const F<V> to = from + by;
    const M<V> inside = logical_and(low <= to, to <= high);
    return {select(inside, samples, F<V>(0.0F)), inside};
  }

  template <class V>
  static RatioRecord<V> sum_neighbour_ratios(const DivMod<V>& pixel, const F<V>& centre, const VisibleRecord<V>& own,
                                             Ports<V>& io) {
    const FinishedUniforms<V>& tile = io.finished;
    F<V> left = -1.0F, right = 1.0F, above = -1.0F, below = 1.0F;
    if constexpr (!kCheckerboard) {  // the step is 0 in columns and rows whose pixels emit rays
      right = to_float(to_int(io.x0 + pixel.remainder) & 1U);
      below = to_float(to_int(io.y0 + pixel.quotient) & 1U);
      left = -right;
      above = -below;
    }
    const std::array<Step<V>, 2> columns{
        step_inside_picture<V>(pixel.remainder, left, left, tile.low_x, tile.high_x),
        step_inside_picture<V>(pixel.remainder, right, right, tile.low_x, tile.high_x)};
    const std::array<Step<V>, 2> rows{
        step_inside_picture<V>(pixel.quotient, above, above * tile.pitch, tile.low_y, tile.high_y),
        step_inside_picture<V>(pixel.quotient, below, below * tile.pitch, tile.low_y, tile.high_y)};
    RatioRecord<V> sum{{0.0F, 0.0F, 0.0F}, 0.0F};
    for (std::uint32_t tap = 0; tap < 4; ++tap) {
      const Step<V>& column = columns[tap % 2];
      const Step<V>& row = rows[tap / 2];
      if constexpr (kCheckerboard) {
        const Step<V>& beside = tap < 2 ? column : rows[tap % 2];
        add_neighbour<V>(sum, centre + beside.samples, beside.inside, own, io);
      } else {
        add_neighbour<V>(sum, centre + column.samples + row.samples, logical_and(column.inside, row.inside), own, io);
      }
    }
    return sum;
  }

  template <class V>
  static void add_neighbour(RatioRecord<V>& sum, const F<V>& index, const M<V>& inside, const VisibleRecord<V>& own,
                            Ports<V>& io) {
    const I<V> sample = to_int(index);
    const RatioRecord<V> ratio = io.ratios.load(sample + io.apart);
    const F<V> alike = Similarity<V>(own, io.visible.load(sample), io.bend).filter_weight();
    const F<V> weight = select(inside, max(alike, F<V>(kUnlikeWeight)) * ratio.found, F<V>(0.0F));
    sum = {sum.rgb + ratio.rgb * weight, sum.found + weight};
  }
};

}  // namespace kernels
