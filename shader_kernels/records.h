#pragma once
#include "shader_kernels/vec3.h"
#include "sim/named.h"
#include "traces/accel/memory_image.h"

namespace kernels {

// Records that kernels load and store. fields() names every member in memory order; with V = float a record is the
// bytes themselves. A ray slot of the tile buffer is Ray + Path + Hit, 64 bytes; a surface is SurfacePoint + Diffuse +
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

/// Path that a ray belongs to: `throughput` is its share of the sample's colour (a shadow ray: the light it
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

/// With mip maps `texture` has the number of the first level in its lower half, and in its upper half, as a bfloat16,
/// the footprint of the ray's cone: its extent in texture coordinates.
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

/// Shares of light that are not scattered.
template <class V>
struct SpecularRecord {
  Vec3<V> mirrored;  ///< share, by channel
  F<V> entering;     ///< share, to be split by Fresnel's law
  Vec3<V> tint;      ///< base colour: factor of the light that is refracted
  F<V> ior;
  F<V> alpha;  ///< share of a blended surface that does not pass straight on
  F<V> kept;   ///< factor of what the surface itself sends out
  static void fields(auto& r, auto&& field) {
    field(NAMED(r.mirrored));
    field(NAMED(r.entering));
    field(NAMED(r.tint));
    field(NAMED(r.ior));
    field(NAMED(r.alpha));
    field(NAMED(r.kept));
  }
};

/// Further attributes of a surface with vertex detail.
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

/// Geometry that a sample keeps of its first hit, to be compared with its neighbours'. A miss has kNoObject and the
/// normal (0, 0, 1), so that two misses are alike.
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

/// Traits of a hit that supersample keeps: as GeometryRecord, without the position, shadows counted.
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

/// Geometry that a sample keeps of its secondary hits: normals of the next hit behind a mirror and behind glass (unit z
/// where there is none), and of all of them a sum of hashes of their objects and one of their shadows, which is the
/// same for the same hits whatever their order.
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

/// Geometry that a sample of reconstruct keeps of a hit: of its first one, or of the next one behind a mirror or glass.
template <class V>
struct VisibleRecord {
  Vec3<V> normal;  ///< as shaded; unit z for a miss
  F<V> depth;      ///< in units of the filter; kMissDepth, kNoBranchDepth
  I<V> shadows;    ///< as in GeometryRecord
  static void fields(auto& r, auto&& field) {
    field(NAMED(r.normal));
    field(NAMED(r.depth));
    field(NAMED(r.shadows));
  }
};
// Depths that no hit has, so far from all others and each other that no weight is left: of a ray that hit nothing, of a
// sample that sends no ray that way, of a pixel outside the picture.
inline constexpr float kMissDepth = 1e9F, kNoBranchDepth = -1e9F, kOutsideDepth = -3e9F;

/// Share of a light's light that reaches a sample, by rays: what they brought, of what they would have unstopped.
template <class V>
struct RatioRecord {
  Vec3<V> rgb;
  F<V> found;  ///< about 1; 0 if there were no rays
  static void fields(auto& r, auto&& field) {
    field(NAMED(r.rgb));
    field(NAMED(r.found));
  }
};

/// Surface that a sample keeps of its first hit if it is to be interpolated and then shaded.
template <class V>
struct SurfaceRecord {
  Vec3<V> diffuse;  ///< before a texture that is kTextured; others are in it
  I<V> classes;
  Vec3<V> plane;  ///< the triangle's own normal, on the side that the ray came from
  F<V> u, v;
  I<V> texture;  ///< as in TexcoordRecord
  I<V> material;
  static void fields(auto& r, auto&& field) {
    field(NAMED(r.diffuse));
    field(NAMED(r.classes));
    field(NAMED(r.plane));
    field(NAMED(r.u));
    field(NAMED(r.v));
    field(NAMED(r.texture));
    field(NAMED(r.material));
  }
};

/// State of a sub-pixel of supersample between rounds of propagation (kernels/subpixels.h).
template <class V>
struct SubpixelRecord {
  I<V> red_green, blue_why;
  static void fields(auto& r, auto&& field) {
    field(NAMED(r.red_green));
    field(NAMED(r.blue_why));
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

}  // namespace kernels
