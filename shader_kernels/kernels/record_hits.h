#pragma once
#include <algorithm>
#include <string_view>
#include <type_traits>

#include "shader_kernels/kernels/arithmetic.h"
#include "shader_kernels/kernels/shade_surface.h"
#include "shader_kernels/ports.h"
#include "sim/named.h"
#include "traces/ray.h"

namespace kernels {

/// Clears the geometry records of samples before they are traced: they begin as misses.
struct ClearGeometry {
  static constexpr std::string_view kName = "clear_geometry";
  static constexpr std::string_view kMeaning = "sample -> its geometry is that of a miss";
  template <class V>
  struct Ports {
    Local<V, WordRecord> samples;
    Local<V, GeometryRecord> geometry;
    static constexpr void describe(auto& p, auto&& port) { name_all(port, NAMED_ALL(p.samples, p.geometry)); }
  };
  template <class V>
  static void body(const I<V>& item, Ports<V>& io) {
    io.geometry.store(io.samples.load(item).word, {{0.0F, 0.0F, 1.0F}, kNoObject, {0.0F, 0.0F, 0.0F}, 0U});
  }
};

struct ClearSecondary {
  static constexpr std::string_view kName = "clear_secondary";
  static constexpr std::string_view kMeaning = "sample -> no secondary hits";
  template <class V>
  struct Ports {
    Local<V, WordRecord> samples;
    Local<V, SecondaryRecord> secondary;
    static constexpr void describe(auto& p, auto&& port) { name_all(port, NAMED_ALL(p.samples, p.secondary)); }
  };
  template <class V>
  static void body(const I<V>& item, Ports<V>& io) {
    io.secondary.store(io.samples.load(item).word, {{0.0F, 0.0F, 1.0F}, 0U, {0.0F, 0.0F, 1.0F}, 0U});
  }
};

struct ClearTraits {
  static constexpr std::string_view kName = "clear_traits";
  static constexpr std::string_view kMeaning = "sample -> its traits are those of a miss, without a secondary hit";
  template <class V>
  struct Ports {
    Local<V, WordRecord> samples;
    Local<V, TraitsRecord> traits, secondary;
    Local<V, BranchRecord> branches;
    static constexpr void describe(auto& p, auto&& port) {
      name_all(port, NAMED_ALL(p.samples, p.traits, p.secondary, p.branches));
    }
  };
  template <class V>
  static void body(const I<V>& item, Ports<V>& io) {
    const I<V> sample = io.samples.load(item).word;
    io.traits.store(sample, {{0.0F, 0.0F, 1.0F}, kNoObject, 0U});
    io.secondary.store(sample, {{0.0F, 0.0F, 1.0F}, kNoObject, 0U});
    io.branches.store(sample, {0.0F, 0.0F});
  }
};

/// Clears the geometry and surface records of samples before they are traced.
struct ClearSurface {
  static constexpr std::string_view kName = "clear_surface";
  static constexpr std::string_view kMeaning = "sample -> its geometry and surface are those of a miss";
  template <class V>
  struct Ports {
    Local<V, WordRecord> samples;
    Local<V, GeometryRecord> geometry;
    Local<V, SurfaceRecord> kept;
    Local<V, ColourRecord> globals;
    static constexpr void describe(auto& p, auto&& port) {
      name_all(port, NAMED_ALL(p.samples, p.geometry, p.kept, p.globals));
    }
  };
  template <class V>
  static void body(const I<V>& item, Ports<V>& io) {
    const I<V> sample = io.samples.load(item).word;
    const Vec3<V> none{0.0F, 0.0F, 0.0F};
    io.geometry.store(sample, {{0.0F, 0.0F, 1.0F}, kNoObject, none, 0U});
    io.kept.store(sample, {none, 0U, {0.0F, 0.0F, 1.0F}, 0.0F, 0.0F, 0U, 0U});
    io.globals.store(sample, {none});
  }
};

/// Material classes whose colour comes from a texture.
inline constexpr std::uint32_t kAnyTexture =
    traces::kTextured | traces::kBased | traces::kPhysical | traces::kBumped | traces::kGlowing;

/// Port of the records from which a hit's object id is loaded: triangles, or with kInstanced instances. The record of
/// the hit's triangle is probably cached, because the intersection unit has just read it.
template <class V, bool kInstanced>
using Objects = std::conditional_t<kInstanced, Instances<V>, Triangles<V>>;

/// Returns the index of the record in Objects that contains a hit's object id.
template <class V>
I<V> object_record_index(const HitRecord<V>& hit) {
  return triangle_index_of<V>(hit);
}
template <class V>
I<V> object_record_index(const InstanceHitRecord<V>& hit) {
  return instance_index_of<V>(hit);
}

/// Returns an object id, with the flag kTexturedObject if the surface has a textured material.
template <class V>
I<V> with_textured_flag(const I<V>& object, const I<V>& classes) {
  return object | select(I<V>(0U) < (classes & kAnyTexture), I<V>(kTexturedObject), I<V>(0U));
}

/// Ports of kernels that record the surface that a sample's primary ray hits.
template <class V, bool kInstanced>
struct SurfaceHitPorts {
  Local<V, WordRecord> surfaces;
  Hits<V, kInstanced> hits;
  Local<V, SurfacePointRecord> points;
  Local<V, DiffuseRecord> mattes;
  Local<V, PathRecord> paths;
  Objects<V, kInstanced> objects;
  static constexpr void describe(auto& p, auto&& port) {
    name_all(port, NAMED_ALL(p.surfaces, p.hits));
    port(p.points, "places");
    name_all(port, NAMED_ALL(p.mattes, p.paths));
    port(p.objects, kInstanced ? "instances" : "triangles");
  }
};

template <class V>
struct SurfaceHit {
  SurfacePointRecord<V> point;
  I<V> object;  ///< object id, with kTexturedObject set if the surface has a texture
  PathRecord<V> path;
};
template <class V, bool kInstanced>
SurfaceHit<V> load_surface_hit(const I<V>& item, const SurfaceHitPorts<V, kInstanced>& io) {
  const I<V> slot = io.surfaces.load(item).word;
  const SurfacePointRecord<V> point = io.points.load(slot);
  const I<V> object = io.objects.load(object_record_index<V>(io.hits.load(slot))).object;
  return {point, with_textured_flag<V>(object, io.mattes.load(slot).classes), io.paths.load(slot)};
}

template <bool kInstanced>
struct RecordGeometry {
  static constexpr std::string_view kName = kInstanced ? "record_geometry_instanced" : "record_geometry";
  static constexpr std::string_view kMeaning = kInstanced
                                                   ? "as record_geometry, with the object of the instance"
                                                   : "first hit -> its sample's geometry: object, normal, position";
  template <class V>
  struct Ports : SurfaceHitPorts<V, kInstanced> {
    Local<V, GeometryRecord> geometry;
    static constexpr void describe(auto& p, auto&& port) {
      SurfaceHitPorts<V, kInstanced>::describe(p, port);
      port(NAMED(p.geometry));
    }
  };
  template <class V>
  static void body(const I<V>& item, Ports<V>& io) {
    const SurfaceHit<V> hit = load_surface_hit<V, kInstanced>(item, io);
    io.geometry.store(hit.path.sample, {hit.point.normal, hit.object, hit.point.position, 0U});
  }
};

template <bool kInstanced>
struct RecordTraits {
  static constexpr std::string_view kName = kInstanced ? "record_traits_instanced" : "record_traits";
  static constexpr std::string_view kMeaning = kInstanced
                                                   ? "as record_traits, with the object of the instance"
                                                   : "first hit -> its sample's traits: object, normal, no shadow yet";
  template <class V>
  struct Ports : SurfaceHitPorts<V, kInstanced> {
    Local<V, TraitsRecord> traits;
    static constexpr void describe(auto& p, auto&& port) {
      SurfaceHitPorts<V, kInstanced>::describe(p, port);
      port(NAMED(p.traits));
    }
  };
  template <class V>
  static void body(const I<V>& item, Ports<V>& io) {
    const SurfaceHit<V> hit = load_surface_hit<V, kInstanced>(item, io);
    io.traits.store(hit.path.sample, {hit.point.normal, hit.object, 0U});
  }
};

/// Returns the normal of a triangle's plane, not normalised.
template <class V>
Vec3<V> scaled_plane_normal(const TriangleFields<V>& t) {
  return cross(t.v1 - t.v0, t.v2 - t.v0);
}

/// Records the geometry of a sample's first hit and the data with which it is interpolated and shaded later. The
/// triangle's normal is turned to the side of the shading normal.
template <bool kInstanced>
struct RecordSurface {
  static constexpr std::string_view kName = kInstanced ? "record_surface_instanced" : "record_surface";
  static constexpr std::string_view kMeaning =
      kInstanced ? "as record_surface, of an instance" : "first hit -> its sample's geometry and surface";
  template <class V>
  struct Ports : RecordGeometry<kInstanced>::template Ports<V> {
    Triangles<V> corners;  ///< triangles, used only if kInstanced; otherwise `objects` are the triangles
    Local<V, TexcoordRecord> texcoords;
    Local<V, SurfaceRecord> kept;
    static constexpr void describe(auto& p, auto&& port) {
      RecordGeometry<kInstanced>::template Ports<V>::describe(p, port);
      if constexpr (kInstanced) port(p.corners, "triangles");
      name_all(port, NAMED_ALL(p.texcoords, p.kept));
    }
  };
  template <class V>
  static void body(const I<V>& item, Ports<V>& io) {
    const I<V> slot = io.surfaces.load(item).word;
    const SurfacePointRecord<V> point = io.points.load(slot);
    const DiffuseRecord<V> matte = io.mattes.load(slot);
    const TexcoordRecord<V> texcoord = io.texcoords.load(slot);
    const auto hit = io.hits.load(slot);
    const auto found = io.objects.load(object_record_index<V>(hit));
    Vec3<V> across;
    if constexpr (kInstanced) {
      across = normal_to_world<V>(found, scaled_plane_normal<V>(io.corners.load(triangle_index_of<V>(hit))));
    } else {
      across = scaled_plane_normal<V>(found);
    }
    const F<V> side = select(dot(across, point.normal) <= 0.0F, F<V>(-1.0F), F<V>(1.0F));
    const I<V> sample = io.paths.load(slot).sample;
    io.geometry.store(sample, {point.normal, with_textured_flag<V>(found.object, matte.classes), point.position, 0U});
    io.kept.store(sample, {matte.diffuse, matte.classes, unit_vector(across) * side, texcoord.u, texcoord.v,
                           texcoord.texture, point.material});
  }
};

/// Uniforms of kernel record_secondary for one bounce. `way` is a hash key of the bounce, so that samples that hit the
/// same objects in different order get different hashes.
template <class V>
struct BounceUniforms {
  I<V> way;
  I<V> mirrored, refracted;  ///< first ray slots of mirrored and of refracted rays; straight rays precede them
  F<V> first;                ///< 1 if normals are recorded in this bounce, otherwise 0
  static constexpr void describe(auto& b, auto&& port) {
    port(NAMED(b.way));
    port(NAMED(b.mirrored));
    port(NAMED(b.refracted));
    port(NAMED(b.first));
  }
};

/// Records the geometry of secondary hits in their samples. One launch per bounce.
template <bool kInstanced>
struct RecordSecondary {
  static constexpr std::string_view kName = kInstanced ? "record_secondary_instanced" : "record_secondary";
  static constexpr std::string_view kMeaning = kInstanced ? "as record_secondary, with the object of the instance"
                                                          : "secondary hit -> into its sample's secondary geometry";
  template <class V>
  struct Ports {
    Local<V, WordRecord> surfaces;
    Hits<V, kInstanced> hits;
    Local<V, SurfacePointRecord> points;
    Local<V, PathRecord> paths;
    Objects<V, kInstanced> objects;
    Local<V, SecondaryRecord> secondary;
    BounceUniforms<V> bounce;
    static constexpr void describe(auto& p, auto&& port) {
      name_all(port, NAMED_ALL(p.surfaces, p.hits));
      port(p.points, "places");
      port(NAMED(p.paths));
      port(p.objects, kInstanced ? "instances" : "triangles");
      port(NAMED(p.secondary));
      BounceUniforms<V>::describe(p.bounce, port);
    }
  };
  template <class V>
  static void body(const I<V>& item, Ports<V>& io) {
    const I<V> slot = io.surfaces.load(item).word;
    const Vec3<V> normal = io.points.load(slot).normal;
    const I<V> object = io.objects.load(object_record_index<V>(io.hits.load(slot))).object;
    const I<V> sample = io.paths.load(slot).sample;
    const SecondaryRecord<V> so_far = io.secondary.load(sample);
    const M<V> is_first = F<V>(0.0F) < io.bounce.first;
    const I<V> kind =
        select(slot < io.bounce.mirrored, I<V>(0U), select(slot < io.bounce.refracted, I<V>(1U), I<V>(2U)));
    const M<V> by_mirror = logical_and(is_first, kind == 1U);
    const M<V> by_glass = logical_and(is_first, kind == 2U);
    io.secondary.store(sample, {select(by_mirror, normal, so_far.mirror_normal),
                                so_far.objects + scramble_bits<V>(object ^ io.bounce.way ^ (kind << 28U)),
                                select(by_glass, normal, so_far.glass_normal), so_far.shadows});
  }
};

// Traits are the data that the program supersample compares between samples. A sample records one of its secondary
// hits: that of the mirrored or refracted ray with the largest weight, one bounce after the first hit.

/// Returns a checksum of a position. Two hits of one sample almost never have equal checksums.
template <class V>
F<V> position_checksum(const Vec3<V>& position) {
  return dot(position, Vec3<V>{1.0F, 1.7320508F, 2.2360680F});
}

/// Finds the largest weight of a sample's mirrored and refracted rays after the first hit. The kernel runs over all
/// these rays, because the ray with the largest weight may hit nothing.
struct WeighBranch {
  static constexpr std::string_view kName = "weigh_branch";
  static constexpr std::string_view kMeaning = "secondary ray -> most that one of its sample carries";
  template <class V>
  struct Ports {
    Local<V, PathRecord> paths;
    Local<V, BranchRecord> branches;
    static constexpr void describe(auto& p, auto&& port) { name_all(port, NAMED_ALL(p.paths, p.branches)); }
  };
  template <class V>
  static void body(const I<V>& item, Ports<V>& io) {
    const PathRecord<V> path = io.paths.load(item);
    const BranchRecord<V> so_far = io.branches.load(path.sample);
    io.branches.store(path.sample, {max(so_far.weight, max_channel(path.throughput)), so_far.position_sum});
  }
};

template <bool kInstanced>
struct RecordBranch {
  static constexpr std::string_view kName = kInstanced ? "record_branch_instanced" : "record_branch";
  static constexpr std::string_view kMeaning = kInstanced ? "as record_branch, with the object of the instance"
                                                          : "secondary hit -> its sample's, if its branch carries most";
  template <class V>
  struct Ports : RecordTraits<kInstanced>::template Ports<V> {
    Local<V, BranchRecord> branches;
    static constexpr void describe(auto& p, auto&& port) {
      RecordTraits<kInstanced>::template Ports<V>::describe(p, port);
      port(NAMED(p.branches));
    }
  };
  template <class V>
  static void body(const I<V>& item, Ports<V>& io) {
    const auto [point, object, path] = load_surface_hit<V, kInstanced>(item, io);
    const TraitsRecord<V> so_far = io.traits.load(path.sample);
    const BranchRecord<V> branch = io.branches.load(path.sample);
    const M<V> most = branch.weight <= max_channel(path.throughput);
    io.traits.store(path.sample,
                    {select(most, point.normal, so_far.normal), select(most, object, so_far.object), so_far.shadows});
    io.branches.store(path.sample,
                      {branch.weight, select(most, position_checksum<V>(point.position), branch.position_sum)});
  }
};

/// Counts the shadows at the recorded mirrored or refracted hit of a sample. The origin of a shadow ray identifies its
/// hit.
struct RecordBranchShadow {
  static constexpr std::string_view kName = "record_branch_shadow";
  static constexpr std::string_view kMeaning = "shadow ray of the kept secondary hit -> counted if it was stopped";
  template <class V>
  struct Ports {
    Local<V, RayRecord> shadow_rays;
    Local<V, HitRecord> shadow_hits;
    Local<V, PathRecord> shadow_paths;
    Local<V, TraitsRecord> traits;
    Local<V, BranchRecord> branches;
    static constexpr void describe(auto& p, auto&& port) {
      name_all(port, NAMED_ALL(p.shadow_rays, p.shadow_hits, p.shadow_paths, p.traits, p.branches));
    }
  };
  template <class V>
  static void body(const I<V>& item, Ports<V>& io) {
    const Vec3<V> origin = io.shadow_rays.load(item).origin;
    const M<V> lit = io.shadow_hits.load(item).triangle == traces::kNoHit;
    const I<V> sample = io.shadow_paths.load(item).sample;
    const M<V> same = position_checksum<V>(origin) == io.branches.load(sample).position_sum;
    TraitsRecord<V> record = io.traits.load(sample);
    record.shadows = record.shadows + select(same, select(lit, I<V>(0U), I<V>(1U)), I<V>(0U));
    io.traits.store(sample, record);
  }
};

/// Contributes to a sample's global colour: all its light except the ambient and local light at the first hit, which
/// interpolated samples compute themselves. The global colour is the sample's colour before local light, minus that
/// after local light, plus its final colour.
template <bool kAfter>
struct RecordLocal {
  static constexpr std::string_view kName = kAfter ? "record_local_after" : "record_local_before";
  static constexpr std::string_view kMeaning = kAfter
                                                   ? "first hit -> its sample's colour behind local shading, taken off"
                                                   : "first hit -> its sample's colour before local shading";
  template <class V>
  struct Ports {
    Local<V, WordRecord> diffuse;
    Local<V, PathRecord> paths;
    Local<V, ColourRecord> colours, globals;
    static constexpr void describe(auto& p, auto&& port) {
      name_all(port, NAMED_ALL(p.diffuse, p.paths, p.colours, p.globals));
    }
  };
  template <class V>
  static void body(const I<V>& item, Ports<V>& io) {
    const I<V> sample = io.paths.load(io.diffuse.load(item).word).sample;
    const Vec3<V> colour = io.colours.load(sample).rgb;
    if constexpr (kAfter) {
      io.globals.store(sample, {io.globals.load(sample).rgb - colour});
    } else {
      io.globals.store(sample, {colour});
    }
  }
};

struct RecordGlobal {
  static constexpr std::string_view kName = "record_global";
  static constexpr std::string_view kMeaning = "traced sample -> its global colour";
  template <class V>
  struct Ports {
    Local<V, WordRecord> samples;
    Local<V, ColourRecord> colours, globals;
    static constexpr void describe(auto& p, auto&& port) { name_all(port, NAMED_ALL(p.samples, p.colours, p.globals)); }
  };
  template <class V>
  static void body(const I<V>& item, Ports<V>& io) {
    const I<V> sample = io.samples.load(item).word;
    io.globals.store(sample, {io.globals.load(sample).rgb + io.colours.load(sample).rgb});
  }
};

/// Returns the largest channel value of a colour that counts as faint. Two faint colours always pass a colour check
/// with `threshold`: channels up to 0.0031 are encoded as 12.92 times themselves, so faint colours differ by at most
/// 3^(1/2) x 12.92 x 0.04 = 0.9 of `threshold`.
inline float largest_faint_channel(float threshold) { return std::min(0.003F, 0.04F * threshold); }

/// Counts the samples whose global colour is not faint. Two faint colours always pass the colour check.
struct CountColoured {
  static constexpr std::string_view kName = "count_coloured";
  static constexpr std::string_view kMeaning = "sample -> number of those whose global colour is not faint";
  template <class V>
  struct Ports {
    Local<V, WordRecord> samples;
    Local<V, ColourRecord> globals;
    Counter<V> coloured_count;
    F<V> faint;  ///< largest channel value of a colour that counts as faint
    static constexpr void describe(auto& p, auto&& port) {
      name_all(port, NAMED_ALL(p.samples, p.globals, p.coloured_count, p.faint));
    }
  };
  template <class V>
  static void body(const I<V>& item, Ports<V>& io) {
    const Vec3<V> global = io.globals.load(io.samples.load(item).word).rgb;
    io.coloured_count.next_index(io.faint < max(max(global.x, global.y), global.z));
  }
};

/// Ports of kernels that record shadows after combine_shadow, one launch per light and bounce. A light source on the
/// far side of the surface casts no shadow on it.
template <template <class> class R>
struct RecordShadowPorts {
  template <class V>
  struct Ports {
    Local<V, HitRecord> shadow_hits;
    Local<V, PathRecord> shadow_paths;
    Local<V, R> records;
    I<V> mark;
    static constexpr void describe(auto& p, auto&& port) {
      name_all(port, NAMED_ALL(p.shadow_hits, p.shadow_paths, p.records, p.mark));
    }
  };
  template <class V>
  static void body(const I<V>& item, Ports<V>& io) {
    const M<V> lit = io.shadow_hits.load(item).triangle == traces::kNoHit;
    const I<V> sample = io.shadow_paths.load(item).sample;
    R<V> record = io.records.load(sample);
    const I<V> mark = select(lit, I<V>(0U), io.mark);
    if constexpr (std::is_same_v<R<V>, GeometryRecord<V>> || std::is_same_v<R<V>, VisibleRecord<V>>) {
      record.shadows = record.shadows | mark;  // lights after the 32nd share bits with earlier ones
    } else {
      record.shadows = record.shadows + mark;
    }
    io.records.store(sample, record);
  }
};

struct RecordShadow : RecordShadowPorts<GeometryRecord> {
  static constexpr std::string_view kName = "record_shadow";
  static constexpr std::string_view kMeaning = "shadow ray of a first hit -> mark in its sample if it was stopped";
};

struct RecordSecondaryShadow : RecordShadowPorts<SecondaryRecord> {
  static constexpr std::string_view kName = "record_secondary_shadow";
  static constexpr std::string_view kMeaning = "shadow ray of a secondary hit -> mark in its sample if it was stopped";
};

struct RecordTraitsShadow : RecordShadowPorts<TraitsRecord> {
  static constexpr std::string_view kName = "record_traits_shadow";
  static constexpr std::string_view kMeaning = "shadow ray of a first hit -> counted in its sample if it was stopped";
};

struct RecordVisibleShadow : RecordShadowPorts<VisibleRecord> {
  static constexpr std::string_view kName = "record_visible_shadow";
  static constexpr std::string_view kMeaning =
      "shadow ray of a first hit, or of one behind it -> mark if it was stopped";
};

}  // namespace kernels
