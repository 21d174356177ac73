#pragma once
#include "shader_kernels/vec3.h"
#include "sim/named.h"

namespace kernels {

// Scene records that kernels load: those of traces/accel/memory_image.h, and texture parameters in the SRP's own
// memory. fields() names every member in memory order.

/// As traces::AttributeRecord.
template <class V>
struct AttributeFields {
  Vec3<V> normal0, normal1, normal2;
  F<V> u0, v0, u1, v1, u2, v2;
  I<V> material;
  static void fields(auto& r, auto&& field) {
    field(NAMED(r.normal0));
    field(NAMED(r.normal1));
    field(NAMED(r.normal2));
    field(NAMED(r.u0));
    field(NAMED(r.v0));
    field(NAMED(r.u1));
    field(NAMED(r.v1));
    field(NAMED(r.u2));
    field(NAMED(r.v2));
    field(NAMED(r.material));
  }
};

/// As traces::TriangleRecord.
template <class V>
struct TriangleFields {
  Vec3<V> v0, v1, v2;
  I<V> object, material, source;
  static void fields(auto& r, auto&& field) {
    field(NAMED(r.v0));
    field(NAMED(r.v1));
    field(NAMED(r.v2));
    field(NAMED(r.object));
    field(NAMED(r.material));
    field(NAMED(r.source));
  }
};

/// As traces::InstanceRecord.
template <class V>
struct InstanceFields {
  Vec3<V> row0;
  F<V> offset0;
  Vec3<V> row1;
  F<V> offset1;
  Vec3<V> row2;
  F<V> offset2;
  I<V> root, object;
  F<V> handedness, volume;
  static void fields(auto& r, auto&& field) {
    field(NAMED(r.row0));
    field(NAMED(r.offset0));
    field(NAMED(r.row1));
    field(NAMED(r.offset1));
    field(NAMED(r.row2));
    field(NAMED(r.offset2));
    field(NAMED(r.root));
    field(NAMED(r.object));
    field(NAMED(r.handedness));
    field(NAMED(r.volume));
  }
};

/// As traces::MaterialRecord.
template <class V>
struct MaterialFields {
  Vec3<V> base_colour;
  F<V> diffuse_share;
  Vec3<V> mirrored;
  F<V> entering;
  Vec3<V> emission;
  F<V> ior;
  I<V> base_texture, flags;
  F<V> opacity, alpha_cutoff;
  static void fields(auto& r, auto&& field) {
    field(NAMED(r.base_colour));
    field(NAMED(r.diffuse_share));
    field(NAMED(r.mirrored));
    field(NAMED(r.entering));
    field(NAMED(r.emission));
    field(NAMED(r.ior));
    field(NAMED(r.base_texture));
    field(NAMED(r.flags));
    field(NAMED(r.opacity));
    field(NAMED(r.alpha_cutoff));
  }
};

/// As traces::VertexRecord.
template <class V>
struct VertexFields {
  F<V> u0, v0, u1, v1, u2, v2;
  I<V> red_green0, blue_alpha0, red_green1, blue_alpha1, red_green2, blue_alpha2;
  I<V> tangent0, tangent1, tangent2, spare;
  static void fields(auto& r, auto&& field) {
    field(NAMED(r.u0));
    field(NAMED(r.v0));
    field(NAMED(r.u1));
    field(NAMED(r.v1));
    field(NAMED(r.u2));
    field(NAMED(r.v2));
    field(NAMED(r.red_green0));
    field(NAMED(r.blue_alpha0));
    field(NAMED(r.red_green1));
    field(NAMED(r.blue_alpha1));
    field(NAMED(r.red_green2));
    field(NAMED(r.blue_alpha2));
    field(NAMED(r.tangent0));
    field(NAMED(r.tangent1));
    field(NAMED(r.tangent2));
    field(NAMED(r.spare));
  }
};

/// As traces::MaterialDetailRecord.
template <class V>
struct DetailFields {
  Vec3<V> emission;
  I<V> normal_texture;
  Vec3<V> absorption;
  I<V> occlusion_texture, metal_rough_texture, emission_texture;
  F<V> normal_scale, occlusion_strength, metallic, roughness, dielectric, coat;
  static void fields(auto& r, auto&& field) {
    field(NAMED(r.emission));
    field(NAMED(r.normal_texture));
    field(NAMED(r.absorption));
    field(NAMED(r.occlusion_texture));
    field(NAMED(r.metal_rough_texture));
    field(NAMED(r.emission_texture));
    field(NAMED(r.normal_scale));
    field(NAMED(r.occlusion_strength));
    field(NAMED(r.metallic));
    field(NAMED(r.roughness));
    field(NAMED(r.dielectric));
    field(NAMED(r.coat));
  }
};

/// Addressing of one axis of a texture, without branches. A coordinate is clamped to [low, high], folded into [0,
/// period), mirrored above 1 and scaled by `size`. A neighbour beyond the lower end is replaced by `below`, beyond the
/// upper end by `last` - `below`. A clamped axis has period 2. `offset` is half a texel for bilinear lookups. For
/// nearest lookups it is 0, and `size` is slightly smaller so that 1 falls within the last texel.
template <class V>
struct AxisRecord {
  F<V> size, last, low, high, period, inverse_period, below, offset;
  static void fields(auto& r, auto&& field) {
    field(NAMED(r.size));
    field(NAMED(r.last));
    field(NAMED(r.low));
    field(NAMED(r.high));
    field(NAMED(r.period));
    field(NAMED(r.inverse_period));
    field(NAMED(r.below));
    field(NAMED(r.offset));
  }
};

/// Mip-level (LOD) parameters of a texture.
template <class V>
struct LevelRecord {
  F<V> size;     ///< side in texels of a square of equal area; for nearest-level lookups times the root of 2
  F<V> highest;  ///< 2 to the power of the last level's number
  static void fields(auto& r, auto&& field) {
    field(NAMED(r.size));
    field(NAMED(r.highest));
  }
};

/// Linear value of an 8-bit sRGB code; the table has 256.
template <class V>
struct SrgbCodeRecord {
  F<V> linear;
  static void fields(auto& r, auto&& field) { field(NAMED(r.linear)); }
};

/// A bilinear footprint: RGBA8 texels at (x0, y0), (x1, y0), (x0, y1), (x1, y1).
template <class V>
struct FootprintRecord {
  I<V> at00, at10, at01, at11;
  static void fields(auto& r, auto&& field) {
    field(NAMED(r.at00));
    field(NAMED(r.at10));
    field(NAMED(r.at01));
    field(NAMED(r.at11));
  }
};

}  // namespace kernels
