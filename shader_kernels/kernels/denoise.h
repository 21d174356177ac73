#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>
#include <type_traits>

#include "shader_kernels/kernels/arithmetic.h"
#include "shader_kernels/kernels/reconstruct.h"
#include "shader_kernels/kernels/subpixels.h"
#include "shader_kernels/kernels/uniforms.h"
#include "shader_kernels/ports.h"
#include "sim/named.h"
#include "traces/ray.h"

namespace kernels {

// Kernels of the denoiser (programs/denoise/denoised.h), after Schied et al. 2017. kHalf: light and moments are stored
// as 16-bit floats.

/// Projection of a camera. The picture position of a point is (across, down) . (point - eye), both divided by its depth
/// axis . (point - eye).
template <class V>
struct ProjectionUniforms {
  Vec3<V> eye, across, down, axis;
};

/// Projections of this frame and the previous one.
template <class V>
struct MotionUniforms {
  ProjectionUniforms<V> now, past;
  static constexpr void describe(auto& m, auto&& port) {
    port(m.now.eye, "now.eye");
    port(m.now.across, "now.across");
    port(m.now.down, "now.down");
    port(m.now.axis, "now.axis");
    port(m.past.eye, "past.eye");
    port(m.past.across, "past.across");
    port(m.past.down, "past.down");
    port(m.past.axis, "past.axis");
  }
};

/// A point or direction in a picture.
template <class V>
struct Projected {
  F<V> x, y, depth;
  Projected(const Vec3<V>& from_eye, const ProjectionUniforms<V>& camera) : depth(dot(from_eye, camera.axis)) {
    const F<V> inverse = 1.0F / depth;
    x = dot(from_eye, camera.across) * inverse;
    y = dot(from_eye, camera.down) * inverse;
  }
};

// Packing of words.

/// Largest finite 16-bit float, and the factor between the exponents of 32-bit and 16-bit floats.
inline constexpr float kLargestHalf = 65504.0F, kHalfScale = 0x1p-112F, kInverseHalfScale = 0x1p112F;

/// Rounds a float that is not negative to the 16 bits of a half, to nearest. Larger values become the largest half.
template <class V>
I<V> pack_half(const F<V>& x) {
  return (bits_of(min(x, F<V>(kLargestHalf)) * kHalfScale) + 0x1000U) >> 13U;
}
template <class V>
F<V> unpack_low_half(const I<V>& word) {
  return from_bits((word << 13U) & 0x0fffe000U) * kInverseHalfScale;
}
template <class V>
F<V> unpack_high_half(const I<V>& word) {
  return from_bits((word >> 3U) & 0x0fffe000U) * kInverseHalfScale;
}

template <class V>
LightRecord<V> unpack_light(const HalfLightRecord<V>& half) {
  return {
      {unpack_low_half<V>(half.red_green), unpack_high_half<V>(half.red_green), unpack_low_half<V>(half.blue_fourth)},
      unpack_high_half<V>(half.blue_fourth)};
}
template <class V>
LightRecord<V> unpack_light(const LightRecord<V>& light) {
  return light;
}
template <class V, bool kHalf>
auto pack_light(const Vec3<V>& rgb, const F<V>& fourth) {
  if constexpr (kHalf) {
    return HalfLightRecord<V>{pack_half<V>(rgb.x) | (pack_half<V>(rgb.y) << 16U),
                              pack_half<V>(rgb.z) | (pack_half<V>(fourth) << 16U)};
  } else {
    return LightRecord<V>{rgb, fourth};
  }
}

template <class V>
MomentsRecord<V> unpack_moments(const WordRecord<V>& half) {
  return {unpack_low_half<V>(half.word), unpack_high_half<V>(half.word)};
}
template <class V>
MomentsRecord<V> unpack_moments(const MomentsRecord<V>& moments) {
  return moments;
}
template <class V, bool kHalf>
auto pack_moments(const F<V>& mean, const F<V>& deviation) {
  if constexpr (kHalf) {
    return WordRecord<V>{pack_half<V>(mean) | (pack_half<V>(deviation) << 16U)};
  } else {
    return MomentsRecord<V>{mean, deviation};
  }
}

/// Ports for light and moments in the tile buffer, and for those in memory.
template <class V, bool kHalf>
using LocalLight = std::conditional_t<kHalf, Local<V, HalfLightRecord>, Local<V, LightRecord>>;
template <class V, bool kHalf>
using LocalMoments = std::conditional_t<kHalf, Local<V, WordRecord>, Local<V, MomentsRecord>>;
template <class V, bool kHalf>
using StoredLight = std::conditional_t<kHalf, Stored<V, HalfLightRecord>, Stored<V, LightRecord>>;
template <class V, bool kHalf>
using StoredMoments = std::conditional_t<kHalf, Stored<V, WordRecord>, Stored<V, MomentsRecord>>;

/// Steps of a motion word per pixel, and the value of no motion. Motion is stored in 1/32 pixel.
inline constexpr float kMotionSteps = 32, kNoMotion = 32768;
/// Scale and offset of a normal's coordinate in a byte.
inline constexpr float kNormalScale = 127, kNormalOffset = 128;
/// Smallest albedo of a diffuse surface by which light is divided, as a byte. Other surfaces, such as mirrors and
/// lamps, count as white, and have shorter normals, so that their light is not mixed with that of diffuse ones.
inline constexpr float kLeastAlbedo = 8, kOtherNormal = 0.5F;

template <class V>
I<V> pack_normal(const Vec3<V>& normal) {
  const auto byte = [](const F<V>& x) { return to_int(x * kNormalScale + (kNormalOffset + 0.5F)); };
  return byte(normal.x) | (byte(normal.y) << 8U) | (byte(normal.z) << 16U);
}
/// Returns a normal's coordinates in bytes.
template <class V>
Vec3<V> unpack_normal(const I<V>& word) {
  return {to_float(extract_byte<V>(word, 0)), to_float(extract_byte<V>(word, 1)), to_float(extract_byte<V>(word, 2))};
}
/// Returns the length of a pixel's history in frames.
template <class V>
F<V> unpack_length(const I<V>& word) {
  return to_float(word >> 24U);
}
template <class V>
Vec3<V> unpack_albedo(const I<V>& word) {
  return unpack_normal<V>(word) * F<V>(1.0F / 255.0F);
}
template <class V>
F<V> luminance(const Vec3<V>& rgb) {
  return rgb.x * 0.2126F + rgb.y * 0.7152F + rgb.z * 0.0722F;
}

/// Clears the guides of samples before they are traced: they begin as misses at infinite distance.
struct ClearGuides {
  static constexpr std::string_view kName = "clear_guides";
  static constexpr std::string_view kMeaning = "primary ray -> its sample's guide is that of a miss";
  template <class V>
  struct Ports {
    Local<V, RayRecord> rays;
    Local<V, PathRecord> paths;
    Local<V, GuideRecord> guides;
    MotionUniforms<V> motion;
    static constexpr void describe(auto& p, auto&& port) {
      name_all(port, NAMED_ALL(p.rays, p.paths, p.guides));
      MotionUniforms<V>::describe(p.motion, port);
    }
  };
  template <class V>
  static void body(const I<V>& item, Ports<V>& io) {
    const Vec3<V> direction = io.rays.load(item).direction;
    const Projected<V> now(direction, io.motion.now), past(direction, io.motion.past);
    io.guides.store(io.paths.load(item).sample, {{0.0F, 0.0F, 0.0F},
                                                 kMissDepth,
                                                 past.x - now.x,
                                                 past.y - now.y,
                                                 select(F<V>(0.0F) < past.depth, F<V>(1.0F), F<V>(0.0F)),
                                                 {1.0F, 1.0F, 1.0F}});
  }
};

/// Ports of the kernels that record the guide of a sample's first hit.
template <class V>
struct GuidePorts {
  Local<V, WordRecord> surfaces;
  Local<V, SurfacePointRecord> points;
  Local<V, DiffuseRecord> mattes;
  Local<V, PathRecord> paths;
  Local<V, GuideRecord> guides;
  MotionUniforms<V> motion;
  static constexpr void describe(auto& p, auto&& port) {
    port(NAMED(p.surfaces));
    port(p.points, "places");
    name_all(port, NAMED_ALL(p.mattes, p.paths, p.guides));
    MotionUniforms<V>::describe(p.motion, port);
  }
};

/// Stores the guide of a hit that was at `before` in the previous frame.
template <class V>
void store_guide(const I<V>& slot, const SurfacePointRecord<V>& point, const Vec3<V>& before, GuidePorts<V>& io) {
  const Projected<V> now(point.position - io.motion.now.eye, io.motion.now);
  const Projected<V> past(before - io.motion.past.eye, io.motion.past);
  const Vec3<V> albedo = io.mattes.load(slot).diffuse;
  const I<V> sample = io.paths.load(slot).sample;
  io.guides.store(sample, {point.normal, now.depth, past.x - now.x, past.y - now.y,
                           max(past.depth / now.depth, F<V>(0.0F)), albedo});
}

/// Records the guide of a sample's first hit in a frame whose triangles have not moved.
struct RecordGuide {
  static constexpr std::string_view kName = "record_guide";
  static constexpr std::string_view kMeaning = "first hit -> its sample's normal, depth, motion, albedo";
  template <class V>
  using Ports = GuidePorts<V>;
  template <class V>
  static void body(const I<V>& item, Ports<V>& io) {
    const I<V> slot = io.surfaces.load(item).word;
    const SurfacePointRecord<V> point = io.points.load(slot);
    store_guide<V>(slot, point, point.position, io);
  }
};

/// Records the guide of a sample's first hit. The hit's previous position is that of its point in the triangle of the
/// previous frame.
struct RecordMovingGuide {
  static constexpr std::string_view kName = "record_moving_guide";
  static constexpr std::string_view kMeaning =
      "first hit of a moving triangle -> its sample's normal, depth, motion, albedo";
  template <class V>
  struct Ports : GuidePorts<V> {
    Local<V, HitRecord> hits;
    Stored<V, PastVertexRecord> vertices;  ///< corners of all triangles in the previous frame
    static constexpr void describe(auto& p, auto&& port) {
      GuidePorts<V>::describe(p, port);
      port(NAMED(p.hits));
      port(p.vertices, "past_vertices");
    }
  };
  template <class V>
  static void body(const I<V>& item, Ports<V>& io) {
    const I<V> slot = io.surfaces.load(item).word;
    const HitRecord<V> hit = io.hits.load(slot);
    const I<V> corner = triangle_index_of<V>(hit) * 3U;
    const Vec3<V> a = io.vertices.load(corner).position;
    const Vec3<V> b = io.vertices.load(corner + 1U).position;
    const Vec3<V> c = io.vertices.load(corner + 2U).position;
    store_guide<V>(slot, io.points.load(slot), Weights<V>(hit).interpolate(a, b, c), io);
  }
};

/// Ports of the kernels that divide the light of samples by albedo.
template <class V, bool kHalf>
struct SplitPorts {
  Local<V, ColourRecord> colours;
  Local<V, GuideRecord> guides;
  LocalLight<V, kHalf> light;
  Local<V, GuideWords> guide_words;
  Local<V, WordRecord> motions, albedos;
  F<V> most;  ///< largest channel of a sample that counts
};

/// Divides the mean colour of a pixel's samples by its mean albedo, and packs the pixel's guide. Sums run over the
/// samples of a pixel; the last one stores the result. Normal, depth and motion are those of the last sample.
template <bool kHalf>
struct SplitLight {
  static constexpr std::string_view kName = kHalf ? "split_light" : "split_light_float";
  static constexpr std::string_view kMeaning = "sample -> its pixel's light without albedo, and its packed guide";
  template <class V>
  struct Ports : SplitPorts<V, kHalf> {
    std::array<LoopCarried<V>, 6> sums;  ///< of colour, then of albedo
    F<V> samples, inverse_samples;
    static constexpr void describe(auto& p, auto&& port) {
      name_all(port, NAMED_ALL(p.colours, p.guides, p.light, p.guide_words, p.motions, p.albedos));
      constexpr std::array<std::string_view, 6> kSums{"red",        "green",        "blue",
                                                      "albedo_red", "albedo_green", "albedo_blue"};
      for (std::size_t i = 0; i < kSums.size(); ++i) port(p.sums[i], kSums[i]);
      name_all(port, NAMED_ALL(p.samples, p.inverse_samples, p.most));
    }
  };
  template <class V>
  static void body(const I<V>& item, Ports<V>& io) {
    const DivMod<V> pixel = div_mod<V>(to_float(item), io.samples, io.inverse_samples);
    const M<V> first = pixel.remainder <= 0.0F;
    const I<V> to = to_int(pixel.quotient);
    store_split<V>(to, item, io, [&](std::size_t channel, const F<V>& clamped) {
      const F<V> sum = select(first, F<V>(0.0F), io.sums[channel].get()) + clamped;
      io.sums[channel].set(sum);
      return sum * io.inverse_samples;
    });
  }

  /// Stores the light and guide of pixel `to`, to which `sample` belongs. `mean(channel, value)` returns the mean of
  /// the pixel's samples so far, with this one; channels 0 to 2 are those of the colour, 3 to 5 those of the albedo.
  template <class V>
  static void store_split(const I<V>& to, const I<V>& sample, SplitPorts<V, kHalf>& io, auto&& mean_of) {
    const Vec3<V> colour = io.colours.load(sample).rgb;
    const GuideRecord<V> guide = io.guides.load(sample);
    const auto mean = [&](std::size_t channel, const F<V>& value, const F<V>& most) {
      return mean_of(channel, min(max(value, F<V>(0.0F)), most));
    };
    const Vec3<V> albedo{mean(3, guide.albedo.x, F<V>(1.0F)), mean(4, guide.albedo.y, F<V>(1.0F)),
                         mean(5, guide.albedo.z, F<V>(1.0F))};
    const M<V> is_diffuse = F<V>(kLeastAlbedo / 255) <= max_channel(albedo);
    const auto byte = [&](const F<V>& x) {
      return to_int(select(is_diffuse, max(x * 255.0F, F<V>(kLeastAlbedo)), F<V>(255.0F)) + 0.5F);
    };
    const I<V> red = byte(albedo.x), green = byte(albedo.y), blue = byte(albedo.z);
    const auto divided = [](const F<V>& channel, const I<V>& albedo_byte) {
      return channel / (to_float(albedo_byte) * (1.0F / 255.0F));
    };
    const Vec3<V> light{divided(mean(0, colour.x, io.most), red), divided(mean(1, colour.y, io.most), green),
                        divided(mean(2, colour.z, io.most), blue)};
    const auto steps = [](const F<V>& pixels) {
      return to_int(min(max(pixels * kMotionSteps + (kNoMotion + 0.5F), F<V>(0.0F)), F<V>(65535.0F)));
    };
    io.light.store(to, pack_light<V, kHalf>(light, guide.depth_ratio));
    const F<V> length = select(is_diffuse, F<V>(1.0F), F<V>(kOtherNormal));
    io.guide_words.store(to, {pack_normal<V>(guide.normal * length), guide.depth});
    io.motions.store(to, {steps(guide.motion_x) | (steps(guide.motion_y) << 16U)});
    io.albedos.store(to, {red | (green << 8U) | (blue << 16U)});
  }
};

/// Replaces split_light for pixels with one sample, in a tile buffer that also has samples of other tiles.
template <bool kHalf>
struct SplitGridLight {
  static constexpr std::string_view kName = kHalf ? "split_grid_light" : "split_grid_light_float";
  static constexpr std::string_view kMeaning = "pixel -> its sample's light without albedo, and its packed guide";
  template <class V>
  struct Ports : SplitPorts<V, kHalf> {
    LatticeUniforms<V> lattice;  ///< indices of the samples of the tile's pixels
    static constexpr void describe(auto& p, auto&& port) {
      name_all(port, NAMED_ALL(p.colours, p.guides, p.light, p.guide_words, p.motions, p.albedos, p.most));
      LatticeUniforms<V>::describe(p.lattice, port);
    }
  };
  template <class V>
  static void body(const I<V>& item, Ports<V>& io) {
    SplitLight<kHalf>::template store_split<V>(item, lattice_sample<V>(item, io.lattice), io,
                                               [](std::size_t /*channel*/, const F<V>& clamped) { return clamped; });
  }
};

/// Position of a tile in the picture, and the picture's size, in pixels.
template <class V>
struct TilePlaceUniforms {
  F<V> x0, y0, width, inverse_width;
  F<V> last_x, last_y, picture_width;  ///< last column and row of the picture, and pixels of its rows
  static constexpr void describe(auto& t, auto&& port) {
    port(t.x0, "tile.x0");
    port(t.y0, "tile.y0");
    port(t.width, "tile.width");
    port(t.inverse_width, "tile.inverse_width");
    port(t.last_x, "picture.last_x");
    port(t.last_y, "picture.last_y");
    port(t.picture_width, "picture.width");
  }
};

/// Adds a pixel's light to its history. The history is read at the pixel's previous position, from the four pixels
/// around it whose depth and normal agree with the pixel's.
///
///   light  = history + max(alpha, 1/n) (light - history)                    n: frames of the history with this one
///   mean   = mean + a (l - mean),  variance = (1 - a) (variance + a (l - mean)^2)      a = max(moments_alpha, 1/n)
///
/// The filter gets the variance of the accumulated light: variance max(alpha, 1/n).
template <bool kHalf>
struct AccumulateHistory {
  static constexpr std::string_view kName = kHalf ? "accumulate_history" : "accumulate_history_float";
  static constexpr std::string_view kMeaning = "pixel -> mean of its light over time, and the light's variance";
  template <class V>
  struct Ports {
    LocalLight<V, kHalf> light, filtered;
    Local<V, GuideWords> guide_words;
    Local<V, WordRecord> motions;
    LocalMoments<V, kHalf> moments;
    Stored<V, GuideWords> stored;
    StoredLight<V, kHalf> stored_light;
    StoredMoments<V, kHalf> stored_moments;
    TilePlaceUniforms<V> tile;
    F<V> alpha, moments_alpha, cap;
    F<V> depth_tolerance, normal_tolerance;  ///< relative difference of depth; squared distance of normals, in bytes
    static constexpr void describe(auto& p, auto&& port) {
      name_all(port, NAMED_ALL(p.light, p.filtered, p.guide_words, p.motions, p.moments));
      port(p.stored, "past_guides");
      port(p.stored_light, "past_light");
      port(p.stored_moments, "past_moments");
      TilePlaceUniforms<V>::describe(p.tile, port);
      name_all(port, NAMED_ALL(p.alpha, p.moments_alpha, p.cap, p.depth_tolerance, p.normal_tolerance));
    }
  };

  template <class V>
  static void body(const I<V>& item, Ports<V>& io) {
    const LightRecord<V> light = unpack_light<V>(io.light.load(item));
    const GuideWords<V> guide = io.guide_words.load(item);
    const I<V> motion = io.motions.load(item).word;
    const DivMod<V> at = div_mod<V>(to_float(item), io.tile.width, io.tile.inverse_width);
    const auto moved = [](const I<V>& steps) { return (to_float(steps) - kNoMotion) * (1.0F / kMotionSteps); };
    const F<V> x = io.tile.x0 + at.remainder + moved(motion & 0xffffU);
    const F<V> y = io.tile.y0 + at.quotient + moved(motion >> 16U);
    const Past<V> past = load_past<V>(x, y, guide, light.fourth, io);

    const F<V> length = min(floor(past.length + 0.5F) + 1.0F, io.cap);
    const F<V> inverse_length = 1.0F / length;
    const F<V> alpha = max(io.alpha, inverse_length), moments_alpha = max(io.moments_alpha, inverse_length);
    const Vec3<V> blended = past.light + (light.rgb - past.light) * alpha;
    const F<V> l = luminance<V>(light.rgb);
    const F<V> change = l - past.mean;
    const F<V> variance = (past.deviation * past.deviation + change * change * moments_alpha) * (1.0F - moments_alpha);
    const F<V> known_variance = select(past.is_known, variance, F<V>(0.0F));
    io.filtered.store(item, pack_light<V, kHalf>(select<V>(past.is_known, blended, light.rgb), known_variance * alpha));
    io.moments.store(item, pack_moments<V, kHalf>(select(past.is_known, past.mean + change * moments_alpha, l),
                                                  sqrt(known_variance)));
    io.guide_words.store(item, {guide.normal | (to_int(length) << 24U), guide.depth});
  }

 private:
  /// A pixel's history at its previous position.
  template <class V>
  struct Past {
    M<V> is_known;
    F<V> length;  ///< 0 if there is no history
    Vec3<V> light;
    F<V> mean, deviation;
  };

  /// Sum of the weights of valid pixels from which a history counts.
  static constexpr float kLeastShare = 0.01F;

  template <class V>
  static Past<V> load_past(const F<V>& x, const F<V>& y, const GuideWords<V>& guide, const F<V>& depth_ratio,
                           Ports<V>& io) {
    const F<V> left = floor(x), top = floor(y), right_share = x - left, bottom_share = y - top;
    const F<V> depth = guide.depth * depth_ratio;
    const Vec3<V> normal = unpack_normal<V>(guide.normal);
    LightRecord<V> first_light{};
    MomentsRecord<V> first_moments{};
    F<V> all{}, length{};
    Vec3<V> light{};
    F<V> mean{}, deviation{};
    for (std::uint32_t tap = 0; tap < 4; ++tap) {
      const F<V> column = (tap & 1U) != 0 ? left + 1.0F : left, row = tap >= 2 ? top + 1.0F : top;
      const M<V> inside = logical_and(logical_and(F<V>(0.0F) <= column, column <= io.tile.last_x),
                                      logical_and(F<V>(0.0F) <= row, row <= io.tile.last_y));
      const I<V> pixel = to_int(select(inside, row * io.tile.picture_width + column, F<V>(0.0F)));
      const GuideWords<V> other = io.stored.load(pixel);
      const LightRecord<V> other_light = unpack_light<V>(io.stored_light.load(pixel));
      const MomentsRecord<V> other_moments = unpack_moments<V>(io.stored_moments.load(pixel));
      const F<V> other_length = unpack_length<V>(other.normal);
      const Vec3<V> apart = unpack_normal<V>(other.normal) - normal;
      const M<V> same =
          logical_and(abs(other.depth - depth) <= depth * io.depth_tolerance, dot(apart, apart) <= io.normal_tolerance);
      const M<V> valid = logical_and(logical_and(inside, same), F<V>(0.0F) < other_length);
      const F<V> share =
          ((tap & 1U) != 0 ? right_share : 1.0F - right_share) * (tap >= 2 ? bottom_share : 1.0F - bottom_share);
      const F<V> weight = select(valid, share, F<V>(0.0F));
      // Differences to the first pixel are averaged, so that equal values give exactly this value.
      if (tap == 0) {
        first_light = other_light;
        first_moments = other_moments;
        all = weight;
        length = other_length * weight;
        continue;
      }
      const Vec3<V> light_part = (other_light.rgb - first_light.rgb) * weight;
      const F<V> mean_part = (other_moments.mean - first_moments.mean) * weight;
      const F<V> deviation_part = (other_moments.deviation - first_moments.deviation) * weight;
      light = tap == 1 ? light_part : light + light_part;
      mean = tap == 1 ? mean_part : mean + mean_part;
      deviation = tap == 1 ? deviation_part : deviation + deviation_part;
      all = all + weight;
      length = length + other_length * weight;
    }
    const M<V> is_known = F<V>(kLeastShare) < all;
    const F<V> inverse = 1.0F / max(all, F<V>(kLeastShare));
    return {is_known, select(is_known, length * inverse, F<V>(0.0F)), first_light.rgb + light * inverse,
            first_moments.mean + mean * inverse, first_moments.deviation + deviation * inverse};
  }
};

/// Unpacks a pixel of a tile or its halo, so that the filter, which reads it 25 times, need not.
template <bool kHalf>
struct UnpackTaps {
  static constexpr std::string_view kName = kHalf ? "unpack_taps" : "unpack_taps_float";
  static constexpr std::string_view kMeaning = "pixel of a tile or its halo -> light, normal and depth as floats";
  template <class V>
  struct Ports {
    LocalLight<V, kHalf> light;
    Local<V, GuideWords> guide_words;
    Local<V, LightRecord> taps;
    Local<V, GuideTapRecord> guide_taps;
    static constexpr void describe(auto& p, auto&& port) {
      name_all(port, NAMED_ALL(p.light, p.guide_words, p.taps, p.guide_taps));
    }
  };
  template <class V>
  static void body(const I<V>& item, Ports<V>& io) {
    const GuideWords<V> guide = io.guide_words.load(item);
    io.taps.store(item, unpack_light<V>(io.light.load(item)));
    io.guide_taps.store(item, {unpack_normal<V>(guide.normal), guide.depth});
  }
};

/// Edge-stopping functions of the filter, and the distance in pixels between its taps.
template <class V>
struct EdgeUniforms {
  F<V> colour, normal, depth;  ///< 1 / phi_colour; phi_normal in bytes squared; 1 / phi_depth
  F<V> step;
  static constexpr void describe(auto& e, auto&& port) {
    port(e.colour, "edge.colour");
    port(e.normal, "edge.normal");
    port(e.depth, "edge.depth");
    port(e.step, "edge.step");
  }
};

/// Where a filter reads its taps: from the tile buffer, in the first iteration and in later ones, or from memory.
enum class TapSource : std::uint8_t { kFirst, kTile, kMemory };

/// One iteration of the a-trous filter: 5 x 5 taps, `step` pixels apart. Weights of a tap:
///
///   kernel       1, 2/3, 1/6 per axis
///   depth        exp(-|dz| / (phi_depth (gx |x| + gy |y|) + kDepthFloor z))       g: smaller difference to a neighbour
///   normal       exp(-phi_normal |dn|^2 / 2)
///   luminance    exp(-|dl| / (phi_colour sqrt(variance)))                         variance: mean of 3 x 3 taps
///
/// In the mean, variances of another geometry weigh less: max(1 - e / kFarExponent, 0), e: exponents of depth and
/// normal. Otherwise the noise of an object would soften the pixels around the object.
///
/// In the first iteration, the variance of pixels with fewer than kYoung frames is that of the taps' luminance,
/// weighted by depth and normal and multiplied by kYoung over the number of frames.
template <bool kHalf, TapSource kSource>
struct FilterLight {
  static constexpr std::array<std::string_view, 6> kNames{"filter_first_light",  "filter_light",
                                                          "filter_stored_light", "filter_first_light_float",
                                                          "filter_light_float",  "filter_stored_light_float"};
  static constexpr std::string_view kName = kNames[static_cast<std::size_t>(kSource) + (kHalf ? 0 : 3)];
  static constexpr std::string_view kMeaning = kSource == TapSource::kMemory
                                                   ? "pixel -> mean of similar pixels around it, read from memory"
                                                   : "pixel -> mean of similar pixels around it";
  static constexpr bool kFromMemory = kSource == TapSource::kMemory, kIsFirst = kSource == TapSource::kFirst;
  static constexpr float kYoung = 4, kDepthFloor = 1e-3F, kLeastVariance = 1e-4F, kFarExponent = 4;
  static constexpr std::uint32_t kSide = 5, kTaps = kSide * kSide, kOwn = kTaps / 2;

  template <class V>
  struct TilePorts {
    FinishedUniforms<V> finished;
    Local<V, LightRecord> taps;
    Local<V, GuideTapRecord> guide_taps;
    Local<V, GuideWords> guide_words;  ///< only in the first iteration
    LocalLight<V, kHalf> filtered;
    EdgeUniforms<V> edge;
    static constexpr void describe(auto& p, auto&& port) {
      FinishedUniforms<V>::describe(p.finished, port);
      name_all(port, NAMED_ALL(p.taps, p.guide_taps));
      if constexpr (kIsFirst) port(NAMED(p.guide_words));
      port(NAMED(p.filtered));
      EdgeUniforms<V>::describe(p.edge, port);
    }
  };
  template <class V>
  struct MemoryPorts {
    FinishedUniforms<V> finished;
    Stored<V, GuideWords> stored;
    StoredLight<V, kHalf> stored_light;
    LocalLight<V, kHalf> filtered;
    EdgeUniforms<V> edge;
    static constexpr void describe(auto& p, auto&& port) {
      FinishedUniforms<V>::describe(p.finished, port);
      port(p.stored, "stored_guides");
      name_all(port, NAMED_ALL(p.stored_light, p.filtered));
      EdgeUniforms<V>::describe(p.edge, port);
    }
  };
  template <class V>
  using Ports = std::conditional_t<kFromMemory, MemoryPorts<V>, TilePorts<V>>;

  template <class V>
  static void body(const I<V>& item, Ports<V>& io) {
    const DivMod<V> pixel = row_and_column<V>(to_float(item), io.finished);
    const F<V> centre = centre_sample<V>(pixel, io.finished);
    const Axis<V> columns =
        axis_steps<V>(pixel.remainder, io.edge.step, F<V>(1.0F), io.finished.low_x, io.finished.high_x);
    const Axis<V> rows =
        axis_steps<V>(pixel.quotient, io.edge.step, io.finished.pitch, io.finished.low_y, io.finished.high_y);
    std::array<Tap<V>, kTaps> taps;
    for (std::uint32_t t = 0; t < kTaps; ++t) {
      taps[t] = load_tap<V>(to_int(centre + columns[t % kSide].offset + rows[t / kSide].offset), io);
    }
    const Tap<V>& own = taps[kOwn];
    const std::array<F<V>, 9> depth_scales = depth_scales_of<V>(taps, columns, rows, io);
    const F<V> own_luminance = luminance<V>(own.rgb);

    // `similar`: weight, or in later iterations exponent, by geometry; `close`: weight of the variance
    std::array<F<V>, kTaps> luminances, similar, close;
    for (std::uint32_t t = 0; t < kTaps; ++t) {
      if (t == kOwn) continue;
      const Vec3<V> apart = taps[t].normal - own.normal;
      const F<V> exponent =
          abs(taps[t].depth - own.depth) * depth_scales[scale_index(t)] + dot(apart, apart) * io.edge.normal;
      luminances[t] = luminance<V>(taps[t].rgb) - own_luminance;
      similar[t] = kIsFirst ? exp_negative<V>(exponent) : exponent;
      if (is_next_to_own(t)) close[t] = max(1.0F - exponent * (1.0F / kFarExponent), F<V>(0.0F));
    }
    F<V> variance;
    std::optional<M<V>> is_young;
    if constexpr (kIsFirst) {
      const F<V> length = unpack_length<V>(io.guide_words.load(to_int(centre)).normal);
      is_young = length < kYoung;
      variance = select(*is_young, variance_of_taps<V>(luminances, similar, columns, rows) * (kYoung / length),
                        mean_variance<V>(taps, close, columns, rows));
    } else {
      variance = mean_variance<V>(taps, close, columns, rows);
    }
    const F<V> colour_scale = io.edge.colour / sqrt(max(variance, F<V>(kLeastVariance)));

    F<V> all = 1.0F, squares = 1.0F, spread = own.variance;
    Vec3<V> light;
    for (std::uint32_t t = 0; t < kTaps; ++t) {
      if (t == kOwn) continue;
      const F<V> by_colour = abs(luminances[t]) * colour_scale;
      const F<V> likeness =
          kIsFirst ? similar[t] * exp_negative<V>(by_colour) : exp_negative<V>(similar[t] + by_colour);
      const M<V> inside = logical_and(columns[t % kSide].inside, rows[t / kSide].inside);
      const F<V> weight = select(inside, likeness * kernel_weight(t), F<V>(0.0F));
      const Vec3<V> part = (taps[t].rgb - own.rgb) * weight;
      const F<V> square = weight * weight;
      light = t == 0 ? part : light + part;
      all = all + weight;
      squares = squares + square;
      spread = spread + taps[t].variance * square;
    }
    const F<V> inverse = 1.0F / all;
    if constexpr (kIsFirst) spread = select(*is_young, variance * squares, spread);
    const Vec3<V> mean = own.rgb + light * inverse;
    const Vec3<V> positive{max(mean.x, F<V>(0.0F)), max(mean.y, F<V>(0.0F)), max(mean.z, F<V>(0.0F))};
    io.filtered.store(item, pack_light<V, kHalf>(positive, spread * inverse * inverse));
  }

 private:
  /// A pixel that the filter reads.
  template <class V>
  struct Tap {
    Vec3<V> rgb;
    F<V> variance;
    Vec3<V> normal;
    F<V> depth;
  };

  /// Offset of a column or row, and whether it is inside the picture; outside, the offset is 0.
  template <class V>
  struct Step {
    F<V> offset;
    M<V> inside;
  };
  /// Returns the steps to five columns or rows around `from`, `step` pixels apart. `pitch`: offset of one pixel.
  template <class V>
  static std::array<Step<V>, kSide> axis_steps(const F<V>& from, const F<V>& step, const F<V>& pitch, const F<V>& low,
                                               const F<V>& high) {
    const auto at = [&](float number) -> Step<V> {
      const F<V> by = step * number;
      const F<V> to = from + by;
      const M<V> inside = logical_and(low <= to, to <= high);
      return {select(inside, by * pitch, F<V>(0.0F)), inside};
    };
    return {at(-2), at(-1), at(0), at(1), at(2)};
  }
  template <class V>
  using Axis = std::array<Step<V>, kSide>;

  static constexpr std::uint32_t distance(std::uint32_t i) { return i < 2 ? 2 - i : i - 2; }
  /// Returns the index in the array of depth scales of tap `t`: 3 x distance in rows + distance in columns.
  static constexpr std::uint32_t scale_index(std::uint32_t t) { return 3 * distance(t / kSide) + distance(t % kSide); }
  static constexpr bool is_next_to_own(std::uint32_t t) {
    return t != kOwn && distance(t / kSide) < 2 && distance(t % kSide) < 2;
  }
  static constexpr float kernel_weight(std::uint32_t t) {
    constexpr std::array<float, 3> kWeights{1.0F, 2.0F / 3.0F, 1.0F / 6.0F};
    return kWeights[distance(t / kSide)] * kWeights[distance(t % kSide)];
  }

  template <class V>
  static Tap<V> load_tap(const I<V>& index, Ports<V>& io) {
    if constexpr (kFromMemory) {
      const GuideWords<V> guide = io.stored.load(index);
      const LightRecord<V> light = unpack_light<V>(io.stored_light.load(index));
      return {light.rgb, light.fourth, unpack_normal<V>(guide.normal), guide.depth};
    } else {
      const LightRecord<V> light = io.taps.load(index);
      const GuideTapRecord<V> guide = io.guide_taps.load(index);
      return {light.rgb, light.fourth, guide.normal, guide.depth};
    }
  }

  /// Returns the factors of depth differences for taps at distances of 0 to 2 columns and rows; the first is unused.
  template <class V>
  static std::array<F<V>, 9> depth_scales_of(const std::array<Tap<V>, kTaps>& taps, const Axis<V>& columns,
                                             const Axis<V>& rows, Ports<V>& io) {
    constexpr float kNoNeighbour = 1e30F;
    const F<V> own = taps[kOwn].depth;
    const auto slope = [&](std::uint32_t before, std::uint32_t after, const Axis<V>& axis) {
      const F<V> below = select(axis[1].inside, abs(taps[before].depth - own), F<V>(kNoNeighbour));
      const F<V> above = select(axis[3].inside, abs(taps[after].depth - own), F<V>(kNoNeighbour));
      return min(below, above);
    };
    const F<V> along_x = slope(kOwn - 1, kOwn + 1, columns), along_y = slope(kOwn - kSide, kOwn + kSide, rows);
    const F<V> least = own * kDepthFloor;
    std::array<F<V>, 9> scales;
    for (std::uint32_t i = 1; i < 9; ++i) {
      const F<V> across = along_x * static_cast<float>(i % 3), down = along_y * static_cast<float>(i / 3);
      const F<V> expected = i % 3 == 0 ? down : i / 3 == 0 ? across : across + down;
      scales[i] = io.edge.depth / (expected + least);
    }
    return scales;
  }

  /// Returns the variance of the taps' luminance, weighted by `similar`. `luminances` are differences to the centre.
  template <class V>
  static F<V> variance_of_taps(const std::array<F<V>, kTaps>& luminances, const std::array<F<V>, kTaps>& similar,
                               const Axis<V>& columns, const Axis<V>& rows) {
    F<V> all = 1.0F, sum = 0.0F, squares = 0.0F;
    for (std::uint32_t t = 0; t < kTaps; ++t) {
      if (t == kOwn) continue;
      const M<V> inside = logical_and(columns[t % kSide].inside, rows[t / kSide].inside);
      const F<V> weight = select(inside, similar[t], F<V>(0.0F));
      const F<V> part = luminances[t] * weight;
      all = all + weight;
      sum = sum + part;
      squares = squares + part * luminances[t];
    }
    const F<V> inverse = 1.0F / all;
    const F<V> mean = sum * inverse;
    return max(squares * inverse - mean * mean, F<V>(0.0F));
  }

  /// Returns the mean variance of 3 x 3 taps, with weights of 1/4, 1/8 and 1/16, times `close`.
  template <class V>
  static F<V> mean_variance(const std::array<Tap<V>, kTaps>& taps, const std::array<F<V>, kTaps>& close,
                            const Axis<V>& columns, const Axis<V>& rows) {
    F<V> all = 0.25F, sum = taps[kOwn].variance * 0.25F;
    for (std::uint32_t t = 0; t < kTaps; ++t) {
      if (!is_next_to_own(t)) continue;
      const float share = t / kSide == kOwn / kSide || t % kSide == kOwn % kSide ? 0.125F : 0.0625F;
      const M<V> inside = logical_and(columns[t % kSide].inside, rows[t / kSide].inside);
      const F<V> weight = select(inside, close[t] * share, F<V>(0.0F));
      all = all + weight;
      sum = sum + taps[t].variance * weight;
    }
    return sum / all;
  }
};

/// Multiplies a pixel's light by its albedo.
template <bool kHalf>
struct ModulateAlbedo {
  static constexpr std::string_view kName = kHalf ? "modulate_albedo" : "modulate_albedo_float";
  static constexpr std::string_view kMeaning = "pixel -> its light times albedo, clamped, in linear light";
  template <class V>
  struct Ports {
    LocalLight<V, kHalf> light;
    Local<V, WordRecord> albedos;
    Local<V, ColourRecord> pixels;
    static constexpr void describe(auto& p, auto&& port) { name_all(port, NAMED_ALL(p.light, p.albedos, p.pixels)); }
  };
  template <class V>
  static void body(const I<V>& item, Ports<V>& io) {
    const Vec3<V> light = unpack_light<V>(io.light.load(item)).rgb;
    io.pixels.store(item, {clamped_colour<V>(light * unpack_albedo<V>(io.albedos.load(item).word))});
  }
};

}  // namespace kernels
