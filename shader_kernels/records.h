#pragma once
#include "shader_kernels/value.h"
#include "sim/named.h"
#include "traces/accel/memory_image.h"

namespace kernels {

// Records that kernels load and store. fields() names every member in memory order; with V = float the record has the
// memory layout itself. A ray slot of the tile buffer is Ray + Path + Hit, 64 bytes. A surface is SurfacePoint +
// Diffuse + Texcoord + Specular, with Tangent if it has vertex detail.

template <class V>
struct RayRecord {
  Vec3<V> origin;
  F<V> t_min;
  Vec3<V> direction;
  F<V> t_max;
  static void fields(auto& r, auto&& field) { name_all(field, NAMED_ALL(r.origin, r.t_min, r.direction, r.t_max)); }
};

/// The path of a ray. `throughput` is the ray's weight in the sample's colour; for a shadow ray, the light it
/// contributes if it is not blocked.
template <class V>
struct PathRecord {
  Vec3<V> throughput;
  I<V> sample;
  static void fields(auto& r, auto&& field) { name_all(field, NAMED_ALL(r.throughput, r.sample)); }
};

template <class V>
struct HitRecord {
  F<V> t, u, v;
  I<V> triangle;
  static void fields(auto& r, auto&& field) { name_all(field, NAMED_ALL(r.t, r.u, r.v, r.triangle)); }
};

/// A hit in a scene with instances: `u` and `v` contain whole numbers (traces/ray.h).
template <class V>
struct InstanceHitRecord {
  F<V> t;
  I<V> u, v, triangle;
  static void fields(auto& r, auto&& field) { name_all(field, NAMED_ALL(r.t, r.u, r.v, r.triangle)); }
};

template <class V>
struct SurfacePointRecord {
  Vec3<V> position;
  I<V> material;
  Vec3<V> normal;  ///< unit length, on the side from which the ray came
  F<V> side;       ///< +1 on the outside, -1 on the inside
  static void fields(auto& r, auto&& field) { name_all(field, NAMED_ALL(r.position, r.material, r.normal, r.side)); }
};

template <class V>
struct DiffuseRecord {
  Vec3<V> diffuse;  ///< base colour times the share of light that is neither mirrored nor transmitted
  I<V> classes;     ///< traces::MaterialFlag; each bit has an item list
  static void fields(auto& r, auto&& field) { name_all(field, NAMED_ALL(r.diffuse, r.classes)); }
};

/// Texture coordinates. With mip maps the lower half of `texture` is the number of the first level, and the upper half,
/// as a bfloat16, the footprint of the ray's cone in texture coordinates.
template <class V>
struct TexcoordRecord {
  F<V> u, v;
  I<V> texture;
  static void fields(auto& r, auto&& field) { name_all(field, NAMED_ALL(r.u, r.v, r.texture)); }
};

/// Light that a surface mirrors, refracts or passes on.
template <class V>
struct SpecularRecord {
  Vec3<V> mirrored;  ///< mirrored share per channel
  F<V> entering;     ///< share that Fresnel's law splits
  Vec3<V> tint;      ///< base colour: factor of the refracted light
  F<V> ior;
  F<V> alpha;  ///< opaque share of a blended surface; the rest passes straight through
  F<V> kept;   ///< factor of the surface's own emission
  static void fields(auto& r, auto&& field) {
    name_all(field, NAMED_ALL(r.mirrored, r.entering, r.tint, r.ior, r.alpha, r.kept));
  }
};

/// More attributes of a surface with vertex detail.
template <class V>
struct TangentRecord {
  Vec3<V> tangent;  ///< about unit length; zero if there is none
  F<V> handedness;  ///< sign of the bitangent
  F<V> u, v;        ///< second texture coordinates
  static void fields(auto& r, auto&& field) { name_all(field, NAMED_ALL(r.tangent, r.handedness, r.u, r.v)); }
};

/// Geometry of a sample's first hit, kept for comparison with neighbours. A miss has kNoObject and the normal (0, 0,
/// 1), so that two misses are equal.
template <class V>
struct GeometryRecord {
  Vec3<V> normal;  ///< shading normal
  I<V> object;     ///< traces::TriangleRecord::object, with kTexturedObject above it
  Vec3<V> position;
  I<V> shadows;  ///< one bit per light whose shadow ray was blocked
  static void fields(auto& r, auto&& field) { name_all(field, NAMED_ALL(r.normal, r.object, r.position, r.shadows)); }
};
inline constexpr std::uint32_t kTexturedObject = 1U << 31;
inline constexpr std::uint32_t kNoObject = traces::kFocusObject - 1;

/// Traits of a hit for supersample: as GeometryRecord, without the position and with a count of shadows.
template <class V>
struct TraitsRecord {
  Vec3<V> normal;
  I<V> object, shadows;
  static void fields(auto& r, auto&& field) { name_all(field, NAMED_ALL(r.normal, r.object, r.shadows)); }
};

/// Identifies a sample's dominant secondary hit during shading: its weight, and a checksum of its position.
template <class V>
struct BranchRecord {
  F<V> weight, position_sum;
  static void fields(auto& r, auto&& field) {
    field(NAMED(r.weight));
    field(r.position_sum, "place");
  }
};

/// Geometry of a sample's secondary hits: the normals of the next hits by mirror and by glass (unit z if none), and
/// sums over all secondary hits of hashes of objects and of shadows, which do not depend on the order of hits.
template <class V>
struct SecondaryRecord {
  Vec3<V> mirror_normal;
  I<V> objects;
  Vec3<V> glass_normal;
  I<V> shadows;
  static void fields(auto& r, auto&& field) {
    name_all(field, NAMED_ALL(r.mirror_normal, r.objects, r.glass_normal, r.shadows));
  }
};

/// Geometry for reconstruct of one hit of a sample: the first, or the next by mirror or glass.
template <class V>
struct VisibleRecord {
  Vec3<V> normal;  ///< shading normal; unit z for a miss
  F<V> depth;      ///< in units of the filter; also kMissDepth, kNoBranchDepth
  I<V> shadows;    ///< as in GeometryRecord
  static void fields(auto& r, auto&& field) { name_all(field, NAMED_ALL(r.normal, r.depth, r.shadows)); }
};
// Depths of a ray without a hit, a sample without such a ray, and a pixel outside the picture. They differ from
// all others that the filter weight is 0.
inline constexpr float kMissDepth = 1e9F, kNoBranchDepth = -1e9F, kOutsideDepth = -3e9F;

/// The visible share of a light at a sample: light contributed by shadow rays, over their light if none were blocked.
template <class V>
struct RatioRecord {
  Vec3<V> rgb;
  F<V> found;  ///< about 1; 0 if there were no rays
  static void fields(auto& r, auto&& field) { name_all(field, NAMED_ALL(r.rgb, r.found)); }
};

/// Surface of a sample's first hit, for samples that are interpolated before shading.
template <class V>
struct SurfaceRecord {
  Vec3<V> diffuse;  ///< without a kTextured texture, with any other
  I<V> classes;
  Vec3<V> plane;  ///< the triangle's geometric normal, on the side from which the ray came
  F<V> u, v;
  I<V> texture;  ///< as in TexcoordRecord
  I<V> material;
  static void fields(auto& r, auto&& field) {
    name_all(field, NAMED_ALL(r.diffuse, r.classes, r.plane, r.u, r.v, r.texture, r.material));
  }
};

/// State of a sub-pixel in supersample between rounds of propagation (kernels/subpixels.h).
template <class V>
struct SubpixelRecord {
  I<V> red_green, blue_why;
  static void fields(auto& r, auto&& field) { name_all(field, NAMED_ALL(r.red_green, r.blue_why)); }
};

template <class V>
struct ColourRecord {
  Vec3<V> rgb;
  static void fields(auto& r, auto&& field) { field(NAMED(r.rgb)); }
};

/// A 32-bit number: an item's slot in an item list, or a pixel of the frame buffer.
template <class V>
struct WordRecord {
  I<V> word;
  static void fields(auto& r, auto&& field) { field(NAMED(r.word)); }
};

// Scene records that kernels load: those of traces/accel/memory_image.h, and texture parameters in the SRP's own
// memory. fields() names every member in memory order.

/// As traces::AttributeRecord.
template <class V>
struct AttributeFields {
  Vec3<V> normal0, normal1, normal2;
  F<V> u0, v0, u1, v1, u2, v2;
  I<V> material;
  static void fields(auto& r, auto&& field) {
    name_all(field, NAMED_ALL(r.normal0, r.normal1, r.normal2, r.u0, r.v0, r.u1, r.v1, r.u2, r.v2, r.material));
  }
};

/// As traces::TriangleRecord.
template <class V>
struct TriangleFields {
  Vec3<V> v0, v1, v2;
  I<V> object, material, source;
  static void fields(auto& r, auto&& field) {
    name_all(field, NAMED_ALL(r.v0, r.v1, r.v2, r.object, r.material, r.source));
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
    name_all(field, NAMED_ALL(r.row0, r.offset0, r.row1, r.offset1, r.row2, r.offset2, r.root, r.object, r.handedness,
                              r.volume));
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
    name_all(field, NAMED_ALL(r.base_colour, r.diffuse_share, r.mirrored, r.entering, r.emission, r.ior, r.base_texture,
                              r.flags, r.opacity, r.alpha_cutoff));
  }
};

/// As traces::VertexRecord.
template <class V>
struct VertexFields {
  F<V> u0, v0, u1, v1, u2, v2;
  I<V> red_green0, blue_alpha0, red_green1, blue_alpha1, red_green2, blue_alpha2;
  I<V> tangent0, tangent1, tangent2, spare;
  static void fields(auto& r, auto&& field) {
    name_all(field, NAMED_ALL(r.u0, r.v0, r.u1, r.v1, r.u2, r.v2, r.red_green0, r.blue_alpha0, r.red_green1,
                              r.blue_alpha1, r.red_green2, r.blue_alpha2, r.tangent0, r.tangent1, r.tangent2, r.spare));
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
    name_all(field, NAMED_ALL(r.emission, r.normal_texture, r.absorption, r.occlusion_texture, r.metal_rough_texture,
                              r.emission_texture, r.normal_scale, r.occlusion_strength, r.metallic, r.roughness,
                              r.dielectric, r.coat));
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
    name_all(field, NAMED_ALL(r.size, r.last, r.low, r.high, r.period, r.inverse_period, r.below, r.offset));
  }
};

/// Mip-level (LOD) parameters of a texture.
template <class V>
struct LevelRecord {
  F<V> size;     ///< side in texels of a square of equal area; for nearest-level lookups times the root of 2
  F<V> highest;  ///< 2 to the power of the last level's number
  static void fields(auto& r, auto&& field) { name_all(field, NAMED_ALL(r.size, r.highest)); }
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
  static void fields(auto& r, auto&& field) { name_all(field, NAMED_ALL(r.at00, r.at10, r.at01, r.at11)); }
};

}  // namespace kernels
