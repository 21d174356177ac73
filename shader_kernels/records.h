#pragma once
#include "shader_kernels/vec3.h"
#include "sim/named.h"
#include "traces/accel/memory_image.h"

namespace kernels {

// What kernels load and store. fields() names every member in memory order; with V = float a record is the bytes
// themselves. A ray slot of the tile buffer is Ray + Path + Hit, 64 bytes; a surface is SurfacePoint + Diffuse +
// Texcoord + Specular, and Tangent where it has vertex detail.

template <class V>
struct RayRecord {
  Vec3<V> origin;
  F<V> t_min;
  Vec3<V> direction;
  F<V> t_max;
  static void fields(auto& r, auto&& field) {
    field(NAMED(r.origin));
    field(NAMED(r.t_min));
    field(NAMED(r.direction));
    field(NAMED(r.t_max));
  }
};

/// What a ray carries for its sample: `throughput` is its share of the sample's colour (a shadow ray: the light it
/// brings if nothing is in its way).
template <class V>
struct PathRecord {
  Vec3<V> throughput;
  I<V> sample;
  static void fields(auto& r, auto&& field) {
    field(NAMED(r.throughput));
    field(NAMED(r.sample));
  }
};

template <class V>
struct HitRecord {
  F<V> t, u, v;
  I<V> triangle;
  static void fields(auto& r, auto&& field) {
    field(NAMED(r.t));
    field(NAMED(r.u));
    field(NAMED(r.v));
    field(NAMED(r.triangle));
  }
};

/// A hit in a scene of instances: the same words, of which `u` and `v` hold whole numbers (traces/ray.h).
template <class V>
struct InstanceHitRecord {
  F<V> t;
  I<V> u, v, triangle;
  static void fields(auto& r, auto&& field) {
    field(NAMED(r.t));
    field(NAMED(r.u));
    field(NAMED(r.v));
    field(NAMED(r.triangle));
  }
};

template <class V>
struct SurfacePointRecord {
  Vec3<V> position;
  I<V> material;
  Vec3<V> normal;  ///< unit, on the side that the ray came from
  F<V> side;       ///< +1 if that is the outside, -1 inside
  static void fields(auto& r, auto&& field) {
    field(NAMED(r.position));
    field(NAMED(r.material));
    field(NAMED(r.normal));
    field(NAMED(r.side));
  }
};

template <class V>
struct DiffuseRecord {
  Vec3<V> diffuse;  ///< base colour, weighted with what is neither mirrored nor let in
  I<V> classes;     ///< traces::MaterialFlag; a bit per stream
  static void fields(auto& r, auto&& field) {
    field(NAMED(r.diffuse));
    field(NAMED(r.classes));
  }
};

template <class V>
struct TexcoordRecord {
  F<V> u, v;
  I<V> texture;
  static void fields(auto& r, auto&& field) {
    field(NAMED(r.u));
    field(NAMED(r.v));
    field(NAMED(r.texture));
  }
};

/// Where light goes that is not scattered.
template <class V>
struct SpecularRecord {
  Vec3<V> mirrored;  ///< share, by channel
  F<V> entering;     ///< share, to be split by Fresnel's law
  F<V> ior;
  F<V> alpha;  ///< of blended surfaces: what does not pass straight on
  F<V> kept;   ///< factor of what the surface itself sends out
  static void fields(auto& r, auto&& field) {
    field(NAMED(r.mirrored));
    field(NAMED(r.entering));
    field(NAMED(r.ior));
    field(NAMED(r.alpha));
    field(NAMED(r.kept));
  }
};

/// What a surface with vertex detail knows besides.
template <class V>
struct TangentRecord {
  Vec3<V> tangent;  ///< about unit; zero where there is none
  F<V> handedness;  ///< sign of the bitangent
  F<V> u, v;        ///< second texture coordinates
  static void fields(auto& r, auto&& field) {
    field(NAMED(r.tangent));
    field(NAMED(r.handedness));
    field(NAMED(r.u));
    field(NAMED(r.v));
  }
};

/// What a sample keeps of its first hit, to be compared with its neighbours'. A miss has kNoObject and the normal
/// (0, 0, 1), so that two misses are alike.
template <class V>
struct GeometryRecord {
  Vec3<V> normal;  ///< as shaded
  I<V> object;     ///< traces::TriangleRecord::object, with kTexturedObject above it
  Vec3<V> position;
  I<V> shadows;  ///< a mark per light whose shadow ray was stopped: its bit
  static void fields(auto& r, auto&& field) {
    field(NAMED(r.normal));
    field(NAMED(r.object));
    field(NAMED(r.position));
    field(NAMED(r.shadows));
  }
};
inline constexpr std::uint32_t kTexturedObject = 1U << 31;
inline constexpr std::uint32_t kNoObject = traces::kFocusObject - 1;

/// What supersample keeps of a hit: as GeometryRecord, without the position, shadows counted.
template <class V>
struct TraitsRecord {
  Vec3<V> normal;
  I<V> object, shadows;
  static void fields(auto& r, auto&& field) {
    field(NAMED(r.normal));
    field(NAMED(r.object));
    field(NAMED(r.shadows));
  }
};

/// Tells a sample's secondary hits apart while they are shaded: the largest share of its colour that a ray carries,
/// and a sum that stands for the point that it hit.
template <class V>
struct BranchRecord {
  F<V> weight, position_sum;
  static void fields(auto& r, auto&& field) {
    field(NAMED(r.weight));
    field(r.position_sum, "place");
  }
};

/// What a sample keeps of its secondary hits: normals of the next hit behind a mirror and behind glass ((0, 0, 1) where
/// there is none), and of all of them a sum of hashes of their objects and one of their shadows, which is the same for
/// the same hits whatever their order.
template <class V>
struct SecondaryRecord {
  Vec3<V> mirror_normal;
  I<V> objects;
  Vec3<V> glass_normal;
  I<V> shadows;
  static void fields(auto& r, auto&& field) {
    field(NAMED(r.mirror_normal));
    field(NAMED(r.objects));
    field(NAMED(r.glass_normal));
    field(NAMED(r.shadows));
  }
};

/// What else a sample keeps of its first hit if it is to be interpolated and then shaded.
template <class V>
struct SurfaceRecord {
  Vec3<V> diffuse;  ///< before a texture that is kTextured; others are in it
  I<V> classes;
  Vec3<V> plane;  ///< the triangle's own normal, on the side that the ray came from
  F<V> u, v;
  I<V> texture;
  static void fields(auto& r, auto&& field) {
    field(NAMED(r.diffuse));
    field(NAMED(r.classes));
    field(NAMED(r.plane));
    field(NAMED(r.u));
    field(NAMED(r.v));
    field(NAMED(r.texture));
  }
};

template <class V>
struct ColourRecord {
  Vec3<V> rgb;
  static void fields(auto& r, auto&& field) { field(NAMED(r.rgb)); }
};

/// A 32-bit number: an item's slot in a stream, or a pixel of the frame buffer.
template <class V>
struct WordRecord {
  I<V> word;
  static void fields(auto& r, auto&& field) { field(NAMED(r.word)); }
};

/// traces::AttributeRecord
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

/// traces::TriangleRecord
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

/// traces::InstanceRecord
template <class V>
struct InstanceFields {
  Vec3<V> row0;
  F<V> offset0;
  Vec3<V> row1;
  F<V> offset1;
  Vec3<V> row2;
  F<V> offset2;
  I<V> root, object;
  F<V> handedness;
  I<V> spare;
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
    field(NAMED(r.spare));
  }
};

/// traces::MaterialRecord
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

/// traces::VertexRecord
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

/// traces::MaterialDetailRecord
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

/// How one axis of a texture is addressed, in a form that needs no branch: a coordinate is clamped to [low, high],
/// folded into [0, period), mirrored above 1 and scaled by `size`. A neighbour that falls off the lower end is `below`,
/// off the other `last` - `below`. A clamped axis has the period 2, which its [0, 1] never leaves.
/// `offset` is half the way from a texel to its neighbour: 0.5. For the nearest texel alone it is 0, and `size` a
/// little less, so that 1 is still within the last texel.
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
