#pragma once
#include <string_view>

#include "shader_kernels/kernels/interpolate_sample.h"
#include "sim/named.h"

namespace kernels {

/// The executor of samples that have passed in adaptive undersampling (Kim et al. 2016): attributes in the middle of
/// two become a surface to be shaded. Along x they are also left for checks along y.
template <bool kAlongY>
struct InterpolateAttributes {
  static constexpr std::string_view kName = kAlongY ? "interpolate_attributes_y" : "interpolate_attributes_x";
  static constexpr std::string_view kMeaning = "sample that passed -> surface between its references, global colour";
  template <class V>
  struct Ports {
    Local<V, WordRecord> passed;
    LineUniforms<V> line;
    Local<V, GeometryRecord> geometry;
    Local<V, SurfaceRecord> kept;
    Local<V, ColourRecord> globals, colours;
    Local<V, WordRecord> surfaces;
    Local<V, SurfacePointRecord> points;
    Local<V, PathRecord> paths;
    Local<V, DiffuseRecord> mattes;
    Local<V, TexcoordRecord> texcoords;
    static void describe(auto& p, auto&& port) {
      port(NAMED(p.passed));
      LineUniforms<V>::describe(p.line, port);
      port(NAMED(p.geometry));
      port(NAMED(p.kept));
      port(NAMED(p.globals));
      port(NAMED(p.colours));
      port(NAMED(p.surfaces));
      port(p.points, "places");
      port(NAMED(p.paths));
      port(NAMED(p.mattes));
      port(NAMED(p.texcoords));
    }
  };
  template <class V>
  static void body(const I<V>& item, Ports<V>& at) {
    const Passed<V> p = passed<V>(at.passed.load(item).word, at.line);
    const GeometryRecord<V> g = lerp_geometry<V>(at.geometry.load(p.before), at.geometry.load(p.after), p.weight);
    const SurfaceRecord<V> a = at.kept.load(p.before);
    const SurfaceRecord<V> b = at.kept.load(p.after);
    const Vec3<V> diffuse = lerp<V>(a.diffuse, b.diffuse, p.weight);
    const F<V> u = lerp<V>(a.u, b.u, p.weight);
    const F<V> v = lerp<V>(a.v, b.v, p.weight);
    const Vec3<V> global = lerp<V>(at.globals.load(p.before).rgb, at.globals.load(p.after).rgb, p.weight);
    at.geometry.store(p.sample, g);
    if constexpr (!kAlongY) {
      at.kept.store(p.sample,
                    {diffuse, a.classes, normalised(lerp<V>(a.plane, b.plane, p.weight)), u, v, a.texture, a.material});
      at.globals.store(p.sample, {global});
    }
    at.colours.store(p.sample, {global});
    at.surfaces.store(item, {item});
    at.points.store(item, {g.position, a.material, g.normal, 1.0F});
    at.paths.store(item, {{1.0F, 1.0F, 1.0F}, p.sample});
    at.mattes.store(item, {diffuse, a.classes});
    at.texcoords.store(item, {u, v, a.texture});
  }
};

}  // namespace kernels
