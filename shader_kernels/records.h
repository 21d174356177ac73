#pragma once
#include "shader_kernels/value.h"
#include "sim/named.h"
#include "traces/accel/memory_image.h"

namespace kernels {

// Records that kernels load and store. fields() names every member in memory order; with V = float the struct has the
// layout of the memory. A ray slot of the tile buffer is Ray + Path + Hit, 64 bytes. A surface is SurfacePoint +
// Diffuse + Texcoord + Specular, with Tangent if it has vertex detail.

template <class V>
struct RayRecord {
  Vec3<V> origin;
  F<V> t_min;
  Vec3<V> direction;
  F<V> t_max;
  static void fields(auto& r, auto&& field) { name_all(field, NAMED_ALL(r.origin, r.t_min, r.direction, r.t_max)); }
};

/// The path that a ray belongs to. `throughput` is the ray's weight in the sample's colour; for a shadow ray, it is the
/// light that arrives if nothing blocks the ray.
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

/// A hit in a scene with instances. `u` and `v` contain barycentric weights in fixed point, and the number of the
/// instance (traces/ray.h).
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
  Vec3<V> normal;  ///< unit normal of the surface, on the side from which the ray came
  F<V> side;       ///< +1 if the ray hit the surface from outside, -1 if from inside
  static void fields(auto& r, auto&& field) { name_all(field, NAMED_ALL(r.position, r.material, r.normal, r.side)); }
};

template <class V>
struct DiffuseRecord {
  Vec3<V> diffuse;  ///< base colour times the fraction of light that is neither mirrored nor transmitted
  I<V> classes;     ///< material classes, as bits of traces::MaterialFlag; each class has its own list of surfaces
  static void fields(auto& r, auto&& field) { name_all(field, NAMED_ALL(r.diffuse, r.classes)); }
};

/// Texture coordinates of a surface. With mip maps the lower half of `texture` is the number of the texture's first
/// level. The upper half is the footprint of the ray's cone in texture coordinates, as a bfloat16.
template <class V>
struct TexcoordRecord {
  F<V> u, v;
  I<V> texture;
  static void fields(auto& r, auto&& field) { name_all(field, NAMED_ALL(r.u, r.v, r.texture)); }
};

/// How a surface mirrors, refracts or passes light.
template <class V>
struct SpecularRecord {
  Vec3<V> mirrored;  ///< fraction of light that is mirrored at any angle, per channel
  F<V> entering;     ///< fraction of light that Fresnel's law divides between mirrored and refracted
  Vec3<V> tint;      ///< base colour, by which refracted light is multiplied
  F<V> ior;
  F<V> alpha;  ///< opacity of a blended surface; the remaining light passes straight through
  F<V> kept;   ///< factor of the surface's own emission: the alpha of a blended surface, otherwise 1
  static void fields(auto& r, auto&& field) {
    name_all(field, NAMED_ALL(r.mirrored, r.entering, r.tint, r.ior, r.alpha, r.kept));
  }
};

/// Tangent and second texture coordinates of a surface with vertex detail.
template <class V>
struct TangentRecord {
  Vec3<V> tangent;  ///< tangent of length about 1, or 0 if the surface has none
  F<V> handedness;  ///< sign of the bitangent
  F<V> u, v;        ///< second texture coordinates
  static void fields(auto& r, auto&& field) { name_all(field, NAMED_ALL(r.tangent, r.handedness, r.u, r.v)); }
};

/// Geometry of a sample's first hit, for comparison with neighbouring samples. A miss has kNoObject and the normal (0,
/// 0, 1), so that two misses are equal.
template <class V>
struct GeometryRecord {
  Vec3<V> normal;  ///< shading normal
  I<V> object;     ///< traces::TriangleRecord::object, with kTexturedObject in the highest bit
  Vec3<V> position;
  I<V> shadows;  ///< one bit for each light source whose shadow ray was blocked
  static void fields(auto& r, auto&& field) { name_all(field, NAMED_ALL(r.normal, r.object, r.position, r.shadows)); }
};
inline constexpr std::uint32_t kTexturedObject = 1U << 31;
inline constexpr std::uint32_t kNoObject = traces::kFocusObject - 1;

/// Data of a hit that the program supersample compares: a GeometryRecord without position, with a count of shadows
/// instead of bits.
template <class V>
struct TraitsRecord {
  Vec3<V> normal;
  I<V> object, shadows;
  static void fields(auto& r, auto&& field) { name_all(field, NAMED_ALL(r.normal, r.object, r.shadows)); }
};

/// Identifies the secondary hit of a sample whose ray has the largest weight, by that weight and a checksum of the
/// hit's position.
template <class V>
struct BranchRecord {
  F<V> weight, position_sum;
  static void fields(auto& r, auto&& field) {
    field(NAMED(r.weight));
    field(r.position_sum, "place");
  }
};

/// Geometry of a sample's secondary hits: the normals after the first mirror and the first glass (unit z if none), and
/// sums of hashes of all secondary objects and shadows. The sums do not depend on the order of hits.
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

/// Geometry that the program reconstruct compares of one hit of a sample: the first hit, or the next one after a mirror
/// or glass.
template <class V>
struct VisibleRecord {
  Vec3<V> normal;  ///< shading normal; unit z for a miss
  F<V> depth;      ///< depth of the hit in units of the filter, or kMissDepth, or kNoBranchDepth
  I<V> shadows;    ///< one bit for each light source whose shadow ray was blocked
  static void fields(auto& r, auto&& field) { name_all(field, NAMED_ALL(r.normal, r.depth, r.shadows)); }
};
// Depths of a ray that hits nothing, of a sample without a mirrored or refracted ray, and of a pixel outside the
// picture. They are so far from all others that the filter weight is 0.
inline constexpr float kMissDepth = 1e9F, kNoBranchDepth = -1e9F, kOutsideDepth = -3e9F;

/// The visible fraction of a light source at a sample: the light that the shadow rays contributed, divided by what they
/// would contribute if none were blocked.
template <class V>
struct RatioRecord {
  Vec3<V> rgb;
  F<V> found;  ///< about 1 if the sample emitted rays to the light source, otherwise 0
  static void fields(auto& r, auto&& field) { name_all(field, NAMED_ALL(r.rgb, r.found)); }
};

/// Surface of a sample's first hit, for samples that are interpolated before they are shaded.
template <class V>
struct SurfaceRecord {
  Vec3<V> diffuse;  ///< diffuse colour after all textures except that of kTextured surfaces, which is applied later
  I<V> classes;
  Vec3<V> plane;  ///< unit normal of the triangle's plane, on the side from which the ray came
  F<V> u, v;
  I<V> texture;  ///< same contents as TexcoordRecord::texture
  I<V> material;
  static void fields(auto& r, auto&& field) {
    name_all(field, NAMED_ALL(r.diffuse, r.classes, r.plane, r.u, r.v, r.texture, r.material));
  }
};

/// State word of a sub-pixel that the program supersample keeps between rounds of propagation. kernels/subpixels.h
/// defines its bits.
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

/// A 32-bit word: an index in a list, or a pixel of the frame buffer.
template <class V>
struct WordRecord {
  I<V> word;
  static void fields(auto& r, auto&& field) { field(NAMED(r.word)); }
};

// Records of the denoiser (kernels/denoise.h). Illumination is colour divided by albedo. Its fourth value is the ratio
// of previous to current depth in the filter's input, and the variance of luminance in all later passes.

/// Guide of a sample: what the denoiser compares of its first hit, and how that moved.
template <class V>
struct GuideRecord {
  Vec3<V> normal;           ///< shading normal; 0 for a miss
  F<V> depth;               ///< depth along the view, or kMissDepth
  F<V> motion_x, motion_y;  ///< position of the hit in the previous picture minus that in this one, in pixels
  F<V> depth_ratio;         ///< depth in the previous picture divided by `depth`
  Vec3<V> albedo;
  static void fields(auto& r, auto&& field) {
    name_all(field, NAMED_ALL(r.normal, r.depth, r.motion_x, r.motion_y, r.depth_ratio, r.albedo));
  }
};

/// Guide of a pixel. `normal`: three bytes, 128 + 127 times a coordinate; the highest byte is the length of the
/// history.
template <class V>
struct GuideWords {
  I<V> normal;
  F<V> depth;
  static void fields(auto& r, auto&& field) { name_all(field, NAMED_ALL(r.normal, r.depth)); }
};

template <class V>
struct LightRecord {
  Vec3<V> rgb;
  F<V> fourth;
  static void fields(auto& r, auto&& field) { name_all(field, NAMED_ALL(r.rgb, r.fourth)); }
};

/// A LightRecord of four 16-bit floats, the first in the low half.
template <class V>
struct HalfLightRecord {
  I<V> red_green, blue_fourth;
  static void fields(auto& r, auto&& field) { name_all(field, NAMED_ALL(r.red_green, r.blue_fourth)); }
};

/// Mean and standard deviation of a pixel's luminance over time.
template <class V>
struct MomentsRecord {
  F<V> mean, deviation;
  static void fields(auto& r, auto&& field) { name_all(field, NAMED_ALL(r.mean, r.deviation)); }
};

/// A pixel's normal and depth in the tile buffer, unpacked for a filter. Coordinates of the normal are in bytes.
template <class V>
struct GuideTapRecord {
  Vec3<V> normal;
  F<V> depth;
  static void fields(auto& r, auto&& field) { name_all(field, NAMED_ALL(r.normal, r.depth)); }
};

/// A corner of a triangle as it was in the previous frame; a triangle has three.
template <class V>
struct PastVertexRecord {
  Vec3<V> position;
  F<V> spare;
  static void fields(auto& r, auto&& field) { name_all(field, NAMED_ALL(r.position, r.spare)); }
};

// Scene records that kernels load: those of traces/accel/memory_image.h, and texture parameters in the SRP's own
// memory. fields() names every member in memory order.

/// The record of a triangle's attributes as a kernel loads it; layout of traces::AttributeRecord.
template <class V>
struct AttributeFields {
  Vec3<V> normal0, normal1, normal2;
  F<V> u0, v0, u1, v1, u2, v2;
  I<V> material;
  static void fields(auto& r, auto&& field) {
    name_all(field, NAMED_ALL(r.normal0, r.normal1, r.normal2, r.u0, r.v0, r.u1, r.v1, r.u2, r.v2, r.material));
  }
};

/// The record of a triangle as a kernel loads it; layout of traces::TriangleRecord.
template <class V>
struct TriangleFields {
  Vec3<V> v0, v1, v2;
  I<V> object, material, source;
  static void fields(auto& r, auto&& field) {
    name_all(field, NAMED_ALL(r.v0, r.v1, r.v2, r.object, r.material, r.source));
  }
};

/// The record of an instance as a kernel loads it; layout of traces::InstanceRecord.
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

/// The record of a material as a kernel loads it; layout of traces::MaterialRecord.
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

/// The record of a triangle's vertex details as a kernel loads it; layout of traces::VertexRecord.
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

/// The record of a material's details as a kernel loads it; layout of traces::MaterialDetailRecord.
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

/// Addressing mode along one axis of a texture. It converts a coordinate to a texel number without branches. A
/// coordinate is clamped to [low, high], folded into [0, period), mirrored above 1 and scaled by `size`. A texel before
/// the first is replaced by `below`, one after the last by `last` - `below`. A clamped axis has period 2. `offset` is
/// half a texel for bilinear lookups. For nearest lookups it is 0, and `size` is slightly smaller so that 1 falls in
/// the last texel.
template <class V>
struct AxisRecord {
  F<V> size, last, low, high, period, inverse_period, below, offset;
  static void fields(auto& r, auto&& field) {
    name_all(field, NAMED_ALL(r.size, r.last, r.low, r.high, r.period, r.inverse_period, r.below, r.offset));
  }
};

/// Parameters with which a lookup finds the mip level of a texture.
template <class V>
struct LevelRecord {
  F<V> size;     ///< square root of the texture's area in texels; times root 2 if lookups read the nearest level
  F<V> highest;  ///< 2 to the power of the number of the last level
  static void fields(auto& r, auto&& field) { name_all(field, NAMED_ALL(r.size, r.highest)); }
};

/// Linear value of an 8-bit sRGB code; an entry of a table with 256 of them.
template <class V>
struct SrgbCodeRecord {
  F<V> linear;
  static void fields(auto& r, auto&& field) { field(NAMED(r.linear)); }
};

/// The four texels (RGBA8) of a bilinear footprint, at (x0, y0), (x1, y0), (x0, y1), (x1, y1).
template <class V>
struct FootprintRecord {
  I<V> at00, at10, at01, at11;
  static void fields(auto& r, auto&& field) { name_all(field, NAMED_ALL(r.at00, r.at10, r.at01, r.at11)); }
};

}  // namespace kernels
