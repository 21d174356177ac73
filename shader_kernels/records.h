#pragma once
#include "shader_kernels/vec3.h"

namespace kernels {

// What kernels load and store. fields() names every member in memory order; with V = float a record is the bytes
// themselves. A ray slot of the tile buffer is Ray + Path + Hit, 64 bytes; a surface is Place + Matte + Texcoord.

template <class V>
struct RayRecord {
  Vec3<V> origin;
  F<V> t_min;
  Vec3<V> direction;
  F<V> t_max;
  static void fields(auto& r, auto&& field) {
    field(r.origin, "origin");
    field(r.t_min, "t_min");
    field(r.direction, "direction");
    field(r.t_max, "t_max");
  }
};

/// What a ray carries for its sample: `throughput` is its share of the sample's colour (a shadow ray: the light it
/// brings if nothing is in its way).
template <class V>
struct PathRecord {
  Vec3<V> throughput;
  I<V> sample;
  static void fields(auto& r, auto&& field) {
    field(r.throughput, "throughput");
    field(r.sample, "sample");
  }
};

template <class V>
struct HitRecord {
  F<V> t, u, v;
  I<V> triangle;
  static void fields(auto& r, auto&& field) {
    field(r.t, "t");
    field(r.u, "u");
    field(r.v, "v");
    field(r.triangle, "triangle");
  }
};

template <class V>
struct PlaceRecord {
  Vec3<V> position;
  I<V> material;
  Vec3<V> normal;  ///< unit, on the side that the ray came from
  F<V> side;       ///< +1 if that is the outside, -1 inside
  static void fields(auto& r, auto&& field) {
    field(r.position, "position");
    field(r.material, "material");
    field(r.normal, "normal");
    field(r.side, "side");
  }
};

/// Bits of MatteRecord::classes, one per stream that classify_surfaces fills.
enum Class : std::uint32_t { kTextured = 1, kDiffuse = 2, kMirror = 4, kGlass = 8, kEmissive = 16 };

template <class V>
struct MatteRecord {
  Vec3<V> diffuse;  ///< base colour, weighted with what is neither mirrored nor let in
  I<V> classes;
  static void fields(auto& r, auto&& field) {
    field(r.diffuse, "diffuse");
    field(r.classes, "classes");
  }
};

template <class V>
struct TexcoordRecord {
  F<V> u, v;
  I<V> texture;
  static void fields(auto& r, auto&& field) {
    field(r.u, "u");
    field(r.v, "v");
    field(r.texture, "texture");
  }
};

template <class V>
struct ColourRecord {
  Vec3<V> rgb;
  static void fields(auto& r, auto&& field) { field(r.rgb, "rgb"); }
};

/// A 32-bit number: an item's slot in a stream, or a pixel of the frame buffer.
template <class V>
struct WordRecord {
  I<V> word;
  static void fields(auto& r, auto&& field) { field(r.word, "word"); }
};

/// traces::AttributeRecord
template <class V>
struct AttributeFields {
  Vec3<V> normal0, normal1, normal2;
  F<V> u0, v0, u1, v1, u2, v2;
  I<V> material;
  static void fields(auto& r, auto&& field) {
    field(r.normal0, "normal0");
    field(r.normal1, "normal1");
    field(r.normal2, "normal2");
    field(r.u0, "u0");
    field(r.v0, "v0");
    field(r.u1, "u1");
    field(r.v1, "v1");
    field(r.u2, "u2");
    field(r.v2, "v2");
    field(r.material, "material");
  }
};

/// traces::MaterialRecord
template <class V>
struct MaterialFields {
  Vec3<V> base_colour;
  F<V> mirror;
  Vec3<V> mirror_tint;
  F<V> transmission;
  Vec3<V> emission;
  F<V> ior;
  I<V> base_texture, spare0, spare1, spare2;
  static void fields(auto& r, auto&& field) {
    field(r.base_colour, "base_colour");
    field(r.mirror, "mirror");
    field(r.mirror_tint, "mirror_tint");
    field(r.transmission, "transmission");
    field(r.emission, "emission");
    field(r.ior, "ior");
    field(r.base_texture, "base_texture");
    field(r.spare0, "spare0");
    field(r.spare1, "spare1");
    field(r.spare2, "spare2");
  }
};

/// How one axis of a texture is addressed, in a form that needs no branch: a coordinate is clamped to [low, high],
/// folded into [0, period), mirrored above 1 and scaled by `size`; a neighbour that falls off one end is `below` or
/// `above`. A clamped axis has the period 2, which its [0, 1] never leaves.
template <class V>
struct AxisRecord {
  F<V> size, last, low, high, period, inverse_period, below, above;
  static void fields(auto& r, auto&& field) {
    field(r.size, "size");
    field(r.last, "last");
    field(r.low, "low");
    field(r.high, "high");
    field(r.period, "period");
    field(r.inverse_period, "inverse_period");
    field(r.below, "below");
    field(r.above, "above");
  }
};

/// A bilinear footprint: RGBA8 texels at (x0, y0), (x1, y0), (x0, y1), (x1, y1).
template <class V>
struct FootprintRecord {
  I<V> at00, at10, at01, at11;
  static void fields(auto& r, auto&& field) {
    field(r.at00, "at00");
    field(r.at10, "at10");
    field(r.at01, "at01");
    field(r.at11, "at11");
  }
};

}  // namespace kernels
