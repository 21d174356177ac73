#pragma once
#include <string_view>

#include "shader_kernels/kernels/record_geometry.h"

namespace kernels {

// Of a sample's secondary hits only one is kept: that of the branch, mirrored or refracted, that carries most, one
// bounce behind the first hit. It is kept as the first hit is.

struct ClearBranch {
  static constexpr std::string_view kName = "clear_branch";
  static constexpr std::string_view kMeaning = "sample -> no secondary hit";
  template <class V>
  struct Ports {
    Local<V, WordRecord> samples;
    Local<V, GeometryRecord> branches;
    Local<V, WeightRecord> weights;
    static void describe(auto& p, auto&& port) {
      port(p.samples, "samples");
      port(p.branches, "branches");
      port(p.weights, "weights");
    }
  };
  template <class V>
  static void body(const I<V>& item, Ports<V>& at) {
    const I<V> sample = at.samples.load(item).word;
    at.branches.store(sample, {{0.0F, 0.0F, 1.0F}, kNoObject, {0.0F, 0.0F, 0.0F}, 0U});
    at.weights.store(sample, {0.0F});
  }
};

/// Over all rays of the first bounce, for the branch that carries most may hit nothing.
struct WeighBranch {
  static constexpr std::string_view kName = "weigh_branch";
  static constexpr std::string_view kMeaning = "secondary ray -> most that one of its sample carries";
  template <class V>
  struct Ports {
    Local<V, PathRecord> paths;
    Local<V, WeightRecord> weights;
    static void describe(auto& p, auto&& port) {
      port(p.paths, "paths");
      port(p.weights, "weights");
    }
  };
  template <class V>
  static void body(const I<V>& item, Ports<V>& at) {
    const PathRecord<V> path = at.paths.load(item);
    at.weights.store(path.sample, {max(at.weights.load(path.sample).weight, largest(path.throughput))});
  }
};

struct RecordBranch {
  static constexpr std::string_view kName = "record_branch";
  static constexpr std::string_view kMeaning = "secondary hit -> its sample's, if its branch carries most";
  template <class V>
  struct Ports {
    Local<V, WordRecord> surfaces;
    Local<V, HitRecord> hits;
    Local<V, PlaceRecord> places;
    Local<V, MatteRecord> mattes;
    Local<V, PathRecord> paths;
    Triangles<V> triangles;
    Local<V, GeometryRecord> branches;
    Local<V, WeightRecord> weights;
    static void describe(auto& p, auto&& port) {
      port(p.surfaces, "surfaces");
      port(p.hits, "hits");
      port(p.places, "places");
      port(p.mattes, "mattes");
      port(p.paths, "paths");
      port(p.triangles, "triangles");
      port(p.branches, "branches");
      port(p.weights, "weights");
    }
  };
  template <class V>
  static void body(const I<V>& item, Ports<V>& at) {
    const I<V> slot = at.surfaces.load(item).word;
    const PlaceRecord<V> place = at.places.load(slot);
    const TriangleFields<V> triangle = at.triangles.load(at.hits.load(slot).triangle & traces::kTriangleMask);
    const I<V> object = object_of<V>(triangle, at.mattes.load(slot).classes);
    const PathRecord<V> path = at.paths.load(slot);
    const GeometryRecord<V> so_far = at.branches.load(path.sample);
    const M<V> most = at.weights.load(path.sample).weight <= largest(path.throughput);
    at.branches.store(path.sample, {select(most, place.normal, so_far.normal), select(most, object, so_far.object),
                                    select(most, place.position, so_far.position), so_far.shadows});
  }
};

/// Shadow rays do not say which branch they belong to, but where they begin.
struct RecordBranchShadow {
  static constexpr std::string_view kName = "record_branch_shadow";
  static constexpr std::string_view kMeaning = "shadow ray of the kept secondary hit -> counted if it was stopped";
  template <class V>
  struct Ports {
    Local<V, RayRecord> shadow_rays;
    Local<V, HitRecord> shadow_hits;
    Local<V, PathRecord> shadow_paths;
    Local<V, GeometryRecord> records;
    static void describe(auto& p, auto&& port) {
      port(p.shadow_rays, "shadow_rays");
      port(p.shadow_hits, "shadow_hits");
      port(p.shadow_paths, "shadow_paths");
      port(p.records, "records");
    }
  };
  template <class V>
  static void body(const I<V>& item, Ports<V>& at) {
    const Vec3<V> origin = at.shadow_rays.load(item).origin;
    const M<V> lit = at.shadow_hits.load(item).triangle == traces::kNoHit;
    const I<V> sample = at.shadow_paths.load(item).sample;
    GeometryRecord<V> record = at.records.load(sample);
    const M<V> same =
        both(both(origin.x == record.position.x, origin.y == record.position.y), origin.z == record.position.z);
    record.shadows = record.shadows + select(same, select(lit, I<V>(0U), I<V>(1U)), I<V>(0U));
    at.records.store(sample, record);
  }
};

}  // namespace kernels
