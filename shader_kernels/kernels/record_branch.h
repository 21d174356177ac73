#pragma once
#include <string_view>

#include "shader_kernels/kernels/record_first_hit.h"
#include "sim/named.h"

namespace kernels {

// Traits are what supersample compares. Of its secondary hits a sample keeps one: that of the branch, mirrored or
// refracted, that carries most, one bounce behind the first hit.

/// A position as one number, which two hits of a sample hardly ever share.
template <class V>
F<V> position_sum(const Vec3<V>& position) {
  return dot(position, Vec3<V>{1.0F, 1.7320508F, 2.2360680F});
}

/// Over all rays of the first bounce, for the branch that carries most may hit nothing.
struct WeighBranch {
  static constexpr std::string_view kName = "weigh_branch";
  static constexpr std::string_view kMeaning = "secondary ray -> most that one of its sample carries";
  template <class V>
  struct Ports {
    Local<V, PathRecord> paths;
    Local<V, BranchRecord> branches;
    static void describe(auto& p, auto&& port) {
      port(NAMED(p.paths));
      port(NAMED(p.branches));
    }
  };
  template <class V>
  static void body(const I<V>& item, Ports<V>& at) {
    const PathRecord<V> path = at.paths.load(item);
    const BranchRecord<V> so_far = at.branches.load(path.sample);
    at.branches.store(path.sample, {max(so_far.weight, largest(path.throughput)), so_far.position_sum});
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
    static void describe(auto& p, auto&& port) {
      RecordTraits<kInstanced>::template Ports<V>::describe(p, port);
      port(NAMED(p.branches));
    }
  };
  template <class V>
  static void body(const I<V>& item, Ports<V>& at) {
    const auto [point, object, path] = surface_hit<V, kInstanced>(item, at);
    const TraitsRecord<V> so_far = at.traits.load(path.sample);
    const BranchRecord<V> branch = at.branches.load(path.sample);
    const M<V> most = branch.weight <= largest(path.throughput);
    at.traits.store(path.sample,
                    {select(most, point.normal, so_far.normal), select(most, object, so_far.object), so_far.shadows});
    at.branches.store(path.sample, {branch.weight, select(most, position_sum<V>(point.position), branch.position_sum)});
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
    Local<V, TraitsRecord> traits;
    Local<V, BranchRecord> branches;
    static void describe(auto& p, auto&& port) {
      port(NAMED(p.shadow_rays));
      port(NAMED(p.shadow_hits));
      port(NAMED(p.shadow_paths));
      port(NAMED(p.traits));
      port(NAMED(p.branches));
    }
  };
  template <class V>
  static void body(const I<V>& item, Ports<V>& at) {
    const Vec3<V> origin = at.shadow_rays.load(item).origin;
    const M<V> lit = at.shadow_hits.load(item).triangle == traces::kNoHit;
    const I<V> sample = at.shadow_paths.load(item).sample;
    const M<V> same = position_sum<V>(origin) == at.branches.load(sample).position_sum;
    TraitsRecord<V> record = at.traits.load(sample);
    record.shadows = record.shadows + select(same, select(lit, I<V>(0U), I<V>(1U)), I<V>(0U));
    at.traits.store(sample, record);
  }
};

}  // namespace kernels
