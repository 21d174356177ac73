#pragma once
#include "shader_kernels/vec3.h"
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
  static void fields(auto& r, auto&& field) {
    field(NAMED(r.origin));
    field(NAMED(r.t_min));
    field(NAMED(r.direction));
    field(NAMED(r.t_max));
  }
};

/// The path of a ray. `throughput` is the ray's weight in the sample's colour; for a shadow ray, the light it
/// contributes if it is not blocked.
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

/// A hit in a scene with instances: `u` and `v` contain whole numbers (traces/ray.h).
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
  Vec3<V> normal;  ///< unit length, on the side from which the ray came
  F<V> side;       ///< +1 on the outside, -1 on the inside
  static void fields(auto& r, auto&& field) {
    field(NAMED(r.position));
    field(NAMED(r.material));
    field(NAMED(r.normal));
    field(NAMED(r.side));
  }
};

template <class V>
struct DiffuseRecord {
  Vec3<V> diffuse;  ///< base colour times the share of light that is neither mirrored nor transmitted
  I<V> classes;     ///< traces::MaterialFlag; each bit has an item list
  static void fields(auto& r, auto&& field) {
    field(NAMED(r.diffuse));
    field(NAMED(r.classes));
  }
};

/// Texture coordinates. With mip maps the lower half of `texture` is the number of the first level, and the upper half,
/// as a bfloat16, the footprint of the ray's cone in texture coordinates.
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
    field(NAMED(r.mirrored));
    field(NAMED(r.entering));
    field(NAMED(r.tint));
    field(NAMED(r.ior));
    field(NAMED(r.alpha));
    field(NAMED(r.kept));
  }
};

/// More attributes of a surface with vertex detail.
template <class V>
struct TangentRecord {
  Vec3<V> tangent;  ///< about unit length; zero if there is none
  F<V> handedness;  ///< sign of the bitangent
  F<V> u, v;        ///< second texture coordinates
  static void fields(auto& r, auto&& field) {
    field(NAMED(r.tangent));
    field(NAMED(r.handedness));
    field(NAMED(r.u));
    field(NAMED(r.v));
  }
};

/// Geometry of a sample's first hit, kept for comparison with neighbours. A miss has kNoObject and the normal (0, 0,
/// 1), so that two misses are equal.
template <class V>
struct GeometryRecord {
  Vec3<V> normal;  ///< shading normal
  I<V> object;     ///< traces::TriangleRecord::object, with kTexturedObject above it
  Vec3<V> position;
  I<V> shadows;  ///< one bit per light whose shadow ray was blocked
  static void fields(auto& r, auto&& field) {
    field(NAMED(r.normal));
    field(NAMED(r.object));
    field(NAMED(r.position));
    field(NAMED(r.shadows));
  }
};
inline constexpr std::uint32_t kTexturedObject = 1U << 31;
inline constexpr std::uint32_t kNoObject = traces::kFocusObject - 1;

/// Traits of a hit for supersample: as GeometryRecord, without the position and with a count of shadows.
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
    field(NAMED(r.mirror_normal));
    field(NAMED(r.objects));
    field(NAMED(r.glass_normal));
    field(NAMED(r.shadows));
  }
};

/// Geometry for reconstruct of one hit of a sample: the first, or the next by mirror or glass.
template <class V>
struct VisibleRecord {
  Vec3<V> normal;  ///< shading normal; unit z for a miss
  F<V> depth;      ///< in units of the filter; also kMissDepth, kNoBranchDepth
  I<V> shadows;    ///< as in GeometryRecord
  static void fields(auto& r, auto&& field) {
    field(NAMED(r.normal));
    field(NAMED(r.depth));
    field(NAMED(r.shadows));
  }
};
// Depths of a ray without a hit, a sample without such a ray, and a pixel outside the picture. They differ so much from
// all others that the filter weight is 0.
inline constexpr float kMissDepth = 1e9F, kNoBranchDepth = -1e9F, kOutsideDepth = -3e9F;

/// The visible share of a light at a sample: light contributed by shadow rays, over their light if none were blocked.
template <class V>
struct RatioRecord {
  Vec3<V> rgb;
  F<V> found;  ///< about 1; 0 if there were no rays
  static void fields(auto& r, auto&& field) {
    field(NAMED(r.rgb));
    field(NAMED(r.found));
  }
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
    field(NAMED(r.diffuse));
    field(NAMED(r.classes));
    field(NAMED(r.plane));
    field(NAMED(r.u));
    field(NAMED(r.v));
    field(NAMED(r.texture));
    field(NAMED(r.material));
  }
};

/// State of a sub-pixel in supersample between rounds of propagation (kernels/subpixels.h).
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

/// A 32-bit number: an item's slot in an item list, or a pixel of the frame buffer.
template <class V>
struct WordRecord {
  I<V> word;
  static void fields(auto& r, auto&& field) { field(NAMED(r.word)); }
};

}  // namespace kernels
