#pragma once
#include <string_view>

#include "shader_kernels/kernels/arithmetic.h"
#include "shader_kernels/kernels/light.h"
#include "shader_kernels/kernels/sampling.h"
#include "shader_kernels/ports.h"
#include "sim/named.h"

namespace kernels {

/// Reduces the throughput of a path by the absorption of the medium that its ray has crossed. Nearest-hit rays have
/// unit directions, so the hit's `t` is the distance.
struct Absorb {
  static constexpr std::string_view kName = "absorb";
  static constexpr std::string_view kMeaning = "surface of an absorbing body -> path dimmed if it was met from inside";
  template <class V>
  struct Ports {
    Local<V, WordRecord> absorbing;
    Local<V, SurfacePointRecord> points;
    Local<V, HitRecord> hits;
    Local<V, PathRecord> paths;
    Details<V> details;
    static constexpr void describe(auto& p, auto&& port) {
      port(NAMED(p.absorbing));
      port(p.points, "places");
      name_all(port, NAMED_ALL(p.hits, p.paths, p.details));
    }
  };
  template <class V>
  static void body(const I<V>& item, Ports<V>& io) {
    const I<V> slot = io.absorbing.load(item).word;
    const SurfacePointRecord<V> point = io.points.load(slot);
    const PathRecord<V> path = io.paths.load(slot);
    const F<V> inside = io.hits.load(slot).t * max(-point.side, F<V>(0.0F));
    const Vec3<V> depth = io.details.load(point.material).absorption * inside;
    const Vec3<V> left{exp_negative<V>(depth.x), exp_negative<V>(depth.y), exp_negative<V>(depth.z)};
    io.paths.store(slot, {path.throughput * left, path.sample});
  }
};

/// Multiplies a surface's base colour by its base texture, for surfaces that the kernel shade_textured excludes: those
/// with second texture coordinates, with a texture whose alpha is used, or with mirror or glass terms that depend on
/// the colour.
template <MipFilter kMips = MipFilter::kNone>
struct ShadeBase {
  static constexpr std::string_view kName =
      variant_name_by_filter<kMips>("shade_base", "shade_base_mip", "shade_base_trilinear");
  static constexpr std::string_view kMeaning =
      variant_name_by_filter<kMips>("surface -> base colour and alpha times a fetch",
                                    "as shade_base, from the nearest mip level", "as shade_base, from two mip levels");
  template <class V>
  struct Ports : DetailPorts<V, kMips> {
    Local<V, SpecularRecord> optics;
    Table<V, SrgbCodeRecord> srgb_codes;
    static constexpr void describe(auto& p, auto&& port) {
      DetailPorts<V, kMips>::describe(p, port);
      name_all(port, NAMED_ALL(p.optics, p.srgb_codes));
    }
  };
  template <class V>
  static void body(const I<V>& item, Ports<V>& io) {
    const I<V> slot = io.stream.load(item).word;
    const DiffuseRecord<V> matte = io.mattes.load(slot);
    const TexcoordRecord<V> uv = io.texcoords.load(slot);
    const TangentRecord<V> other = io.tangents.load(slot);
    SpecularRecord<V> optics = io.optics.load(slot);
    const auto base = io.look_up(texture_number<V, kMips>(uv), matte.classes, traces::kBaseSecond, uv, other);
    const Vec3<V> colour = base.srgb_colour(io.srgb_codes);
    io.mattes.store(slot, {matte.diffuse * colour, matte.classes});
    optics.tint = optics.tint * colour;
    optics.alpha = optics.alpha * base.linear_channel(3);
    io.optics.store(slot, optics);
  }
};

/// Applies a metal-roughness texture with the rule of traces/scene/gltf/materials.h: computes how much light the
/// surface mirrors, in which colour, and how much remains. The input surface has its full base colour as diffuse
/// colour, and transmits light as if it mirrored none.
/// With kRough the surface gets its GGX roughness, and mirrors as much as smooth facets do.
template <MipFilter kMips = MipFilter::kNone, bool kRough = false>
struct ShadePhysical {
  static constexpr std::string_view kName =
      kRough ? variant_name_by_filter<kMips>("shade_physical_rough", "shade_physical_rough_mip",
                                             "shade_physical_rough_trilinear")
             : variant_name_by_filter<kMips>("shade_physical", "shade_physical_mip", "shade_physical_trilinear");
  static constexpr std::string_view kMeaning =
      kRough ? variant_name_by_filter<kMips>("as shade_physical, with GGX roughness",
                                             "as shade_physical_rough, from the nearest mip level",
                                             "as shade_physical_rough, from two mip levels")
             : variant_name_by_filter<kMips>("surface with a metallic-roughness texture -> mirror and diffuse shares",
                                             "as shade_physical, from the nearest mip level",
                                             "as shade_physical, from two mip levels");
  template <class V>
  struct Ports : DetailPorts<V, kMips> {
    Local<V, SurfacePointRecord> points;
    Local<V, SpecularRecord> optics;
    Details<V> details;
    static constexpr void describe(auto& p, auto&& port) {
      DetailPorts<V, kMips>::describe(p, port);
      port(p.points, "places");
      name_all(port, NAMED_ALL(p.optics, p.details));
    }
  };
  template <class V>
  static void body(const I<V>& item, Ports<V>& io) {
    const I<V> slot = io.stream.load(item).word;
    const DiffuseRecord<V> matte = io.mattes.load(slot);
    const TexcoordRecord<V> uv = io.texcoords.load(slot);
    const TangentRecord<V> other = io.tangents.load(slot);
    const DetailFields<V> m = io.details.load(io.points.load(slot).material);
    SpecularRecord<V> optics = io.optics.load(slot);
    const auto texel = io.look_up(m.metal_rough_texture, matte.classes, traces::kMetalRoughSecond, uv, other);

    const F<V> roughness = m.roughness * texel.linear_channel(1);
    F<V> gloss = clamp_to_unit<V>((0.5F - roughness) * 2.5F);
    F<V> dielectric = m.dielectric, coat = m.coat;
    I<V> rough_bits{};
    if constexpr (kRough) {
      const M<V> is_rough = logical_and(F<V>(traces::kLeastRoughness) <= roughness, optics.entering <= 0.0F);
      gloss = select(is_rough, F<V>(1.0F), gloss);
      dielectric = select(is_rough, dielectric * 0.5F, dielectric);
      coat = select(is_rough, F<V>(0.0F), coat);
      rough_bits = select(is_rough, to_int(roughness * 255.0F + 0.5F) << traces::kRoughnessShift, I<V>(0U));
    }
    const F<V> metallic = m.metallic * texel.linear_channel(2);
    const F<V> metal = gloss * metallic;
    const F<V> white = (gloss - metal) * dielectric + coat;
    const F<V> sum = metal + white;
    // A mirrored fraction below 0.02 emits no ray; a sum above 1 is scaled down to conserve energy.
    const F<V> scale = select(sum < 0.02F, F<V>(0.0F), 1.0F / max(sum, F<V>(1.0F)));
    optics.mirrored = (matte.diffuse * metal + Vec3<V>{white, white, white}) * scale;
    const F<V> left = 1.0F - sum * scale;
    const Vec3<V> diffuse = matte.diffuse * (left * (1.0F - optics.entering));
    optics.entering = optics.entering * left;
    const auto bit = [](const M<V>& mask, traces::MaterialFlag flag) {
      return select(mask, I<V>(static_cast<std::uint32_t>(flag)), I<V>(0U));
    };
    I<V> classes = matte.classes | bit(F<V>(0.0F) < max_channel(diffuse), traces::kDiffuse) |
                   bit(F<V>(0.0F) < max_channel(optics.mirrored), traces::kMirror);
    if constexpr (kRough) classes = classes | rough_bits;
    io.mattes.store(slot, {diffuse, classes});
    io.optics.store(slot, optics);
  }
};

/// Applies a normal map in tangent space, as glTF defines it. A surface without a tangent keeps its normal. A mapped
/// normal that faces away from the ray is turned back until the ray grazes the surface.
template <MipFilter kMips = MipFilter::kNone>
struct ShadeBump {
  static constexpr std::string_view kName =
      variant_name_by_filter<kMips>("shade_bump", "shade_bump_mip", "shade_bump_trilinear");
  static constexpr std::string_view kMeaning =
      variant_name_by_filter<kMips>("surface with a normal map -> its normal from the map",
                                    "as shade_bump, from the nearest mip level", "as shade_bump, from two mip levels");
  template <class V>
  struct Ports : DetailPorts<V, kMips> {
    Local<V, RayRecord> rays;
    Local<V, SurfacePointRecord> points;
    Details<V> details;
    static constexpr void describe(auto& p, auto&& port) {
      DetailPorts<V, kMips>::describe(p, port);
      port(NAMED(p.rays));
      port(p.points, "places");
      port(NAMED(p.details));
    }
  };
  template <class V>
  static void body(const I<V>& item, Ports<V>& io) {
    const I<V> slot = io.stream.load(item).word;
    const I<V> classes = io.mattes.load(slot).classes;
    const TexcoordRecord<V> uv = io.texcoords.load(slot);
    const TangentRecord<V> frame = io.tangents.load(slot);
    const Vec3<V> direction = io.rays.load(slot).direction;
    SurfacePointRecord<V> point = io.points.load(slot);
    const DetailFields<V> m = io.details.load(point.material);
    const auto texel = io.look_up(m.normal_texture, classes, traces::kNormalSecond, uv, frame);

    const F<V> x = (texel.linear_channel(0) * 2.0F - 1.0F) * m.normal_scale;
    const F<V> y = (texel.linear_channel(1) * 2.0F - 1.0F) * m.normal_scale;
    const F<V> z = max(texel.linear_channel(2) * 2.0F - 1.0F, F<V>(0.01F));
    const Vec3<V> normal = point.normal * point.side;  // the normal on the outside
    const Vec3<V> bitangent = cross(normal, frame.tangent);
    const Vec3<V> mapped = frame.tangent * x + bitangent * (y * frame.handedness) + normal * z;
    const Vec3<V> facing = unit_vector(mapped) * point.side;
    const F<V> away = max(dot(facing, direction) + 0.01F, F<V>(0.0F));
    point.normal = unit_vector(facing - direction * away);
    io.points.store(slot, point);
  }
};

/// Scales the light that a blended surface reflects by its alpha. The kernel shade_straight continues the ray with the
/// remaining light.
struct ShadeBlend {
  static constexpr std::string_view kName = "shade_blend";
  static constexpr std::string_view kMeaning = "blended surface -> all that it sends out, times its alpha";
  template <class V>
  struct Ports {
    Local<V, WordRecord> blended;
    Local<V, DiffuseRecord> mattes;
    Local<V, SpecularRecord> optics;
    static constexpr void describe(auto& p, auto&& port) { name_all(port, NAMED_ALL(p.blended, p.mattes, p.optics)); }
  };
  template <class V>
  static void body(const I<V>& item, Ports<V>& io) {
    const I<V> slot = io.blended.load(item).word;
    const DiffuseRecord<V> matte = io.mattes.load(slot);
    SpecularRecord<V> optics = io.optics.load(slot);
    io.mattes.store(slot, {matte.diffuse * optics.alpha, matte.classes});
    optics.mirrored = optics.mirrored * optics.alpha;
    optics.entering = optics.entering * optics.alpha;
    optics.kept = optics.alpha;
    io.optics.store(slot, optics);
  }
};

template <MipFilter kMips = MipFilter::kNone>
struct ShadeGlow {
  static constexpr std::string_view kName =
      variant_name_by_filter<kMips>("shade_glow", "shade_glow_mip", "shade_glow_trilinear");
  static constexpr std::string_view kMeaning =
      variant_name_by_filter<kMips>("surface with an emission texture -> its own light into its sample",
                                    "as shade_glow, from the nearest mip level", "as shade_glow, from two mip levels");
  template <class V>
  struct Ports : DetailPorts<V, kMips> {
    Local<V, SurfacePointRecord> points;
    Local<V, PathRecord> paths;
    Local<V, SpecularRecord> optics;
    Details<V> details;
    Local<V, ColourRecord> colours;
    Table<V, SrgbCodeRecord> srgb_codes;
    static constexpr void describe(auto& p, auto&& port) {
      DetailPorts<V, kMips>::describe(p, port);
      port(p.points, "places");
      name_all(port, NAMED_ALL(p.paths, p.optics, p.details, p.colours, p.srgb_codes));
    }
  };
  template <class V>
  static void body(const I<V>& item, Ports<V>& io) {
    const I<V> slot = io.stream.load(item).word;
    const I<V> classes = io.mattes.load(slot).classes;
    const TexcoordRecord<V> uv = io.texcoords.load(slot);
    const TangentRecord<V> other = io.tangents.load(slot);
    const PathRecord<V> path = io.paths.load(slot);
    const F<V> kept = io.optics.load(slot).kept;
    const DetailFields<V> m = io.details.load(io.points.load(slot).material);
    const auto texel = io.look_up(m.emission_texture, classes, traces::kEmissionSecond, uv, other);
    add_light<V>(io.colours, path.sample, path.throughput * (m.emission * texel.srgb_colour(io.srgb_codes)) * kept);
  }
};

/// Subtracts the ambient light that a surface's occlusion texture removes. The kernel shade_ambient has added the full
/// ambient light before.
template <MipFilter kMips = MipFilter::kNone>
struct ShadeOccluded {
  static constexpr std::string_view kName =
      variant_name_by_filter<kMips>("shade_occluded", "shade_occluded_mip", "shade_occluded_trilinear");
  static constexpr std::string_view kMeaning = variant_name_by_filter<kMips>(
      "surface with an occlusion texture -> ambient light taken back", "as shade_occluded, from the nearest mip level",
      "as shade_occluded, from two mip levels");
  template <class V>
  struct Ports : DetailPorts<V, kMips> {
    Local<V, SurfacePointRecord> points;
    Local<V, PathRecord> paths;
    Details<V> details;
    Local<V, ColourRecord> colours;
    Vec3<V> ambient;
    static constexpr void describe(auto& p, auto&& port) {
      DetailPorts<V, kMips>::describe(p, port);
      port(p.points, "places");
      name_all(port, NAMED_ALL(p.paths, p.details, p.colours, p.ambient));
    }
  };
  template <class V>
  static void body(const I<V>& item, Ports<V>& io) {
    const I<V> slot = io.stream.load(item).word;
    const DiffuseRecord<V> matte = io.mattes.load(slot);
    const TexcoordRecord<V> uv = io.texcoords.load(slot);
    const TangentRecord<V> other = io.tangents.load(slot);
    const PathRecord<V> path = io.paths.load(slot);
    const DetailFields<V> m = io.details.load(io.points.load(slot).material);
    const auto texel = io.look_up(m.occlusion_texture, matte.classes, traces::kOcclusionSecond, uv, other);
    const F<V> taken = (texel.linear_channel(0) - 1.0F) * m.occlusion_strength;
    add_light<V>(io.colours, path.sample, path.throughput * matte.diffuse * io.ambient * taken);
  }
};

}  // namespace kernels
