#include "traces/accel/embree_tracer.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <cstddef>
#include <vector>

#include <glm/geometric.hpp>
#include <glm/mat4x4.hpp>
#include <glm/matrix.hpp>

#include "traces/accel/build/two_level.h"
#include "traces/accel/embree_api.h"
#include "traces/accel/ray_tests.h"

#if RTC_VERSION_MAJOR < 4
using RTCRayQueryContext = RTCIntersectContext;
inline void rtcInitRayQueryContext(RTCRayQueryContext* context) { rtcInitIntersectContext(context); }
#endif

namespace traces {
namespace {

/// Hits whose distances differ by less than this fraction count as equal, and BvhTracer's rule selects one. The
/// fraction is far above rounding error, and a tenth of the tolerance with which verification compares distances.
constexpr float kTieOfDistance = 1e-5F;
constexpr float kTieOfDiagonal = 1e-6F;

/// An Embree setting without fused multiply-add, so that edge tests round as in BvhTracer on every processor.
const std::string kInstructionSet = "isa=sse4.2";

/// Sort key of hits in BvhTracer's rule: hits inside the triangle by its test come first; then by distance, instance
/// and triangle number.
struct Rank {
  bool inside = false;
  float t = 0;
  std::uint32_t instance = 0, source = 0;
  bool comes_before(const Rank& other) const {
    if (inside != other.inside) return inside;
    if (t != other.t) return t < other.t;
    return instance != other.instance ? instance < other.instance : source < other.source;
  }
};

/// State of one nearest-hit query. The filter function receives a pointer to Embree's context, so the context must be
/// the first member.
struct Query {
  RTCRayQueryContext context;
  const MemoryImage* image = nullptr;
  const Ray* ray = nullptr;
  bool is_single_sided = false;
  float tie = 0;  ///< the part of the tie distance that does not depend on `t`
  Hit best;
  Rank rank;

  RayTriangles<NativeLanes>::Result test_triangle(std::uint32_t instance, const TriangleRecord& record) const {
    const Ray seen = image->has_two_levels() ? to_object_space(image->instances[instance], *ray) : *ray;
    return RayTriangles<NativeLanes>(seen).test_triangles(&record, 1);
  }
  /// True unless the triangle's face on the ray's side is culled.
  bool is_face_visible(std::uint32_t instance, std::uint32_t triangle) const {
    if (!is_single_sided) return true;
    const TriangleRecord& record = image->triangles[triangle];
    return test_triangle(instance, record).culled_mask(&record, 1) == 0;
  }
  Rank rank_of(std::uint32_t instance, std::uint32_t triangle) const {
    const TriangleRecord& record = image->triangles[triangle];
    const auto result = test_triangle(instance, record);
    std::array<float, 4> t;
    result.t.store(t.data());
    return {(result.inside_mask() & 1U) != 0, t[0], instance, record.source};
  }
  /// Returns the largest distance at which a hit counts as equal to the best hit.
  float tie_limit() const { return std::min(best.t + kTieOfDistance * best.t + tie, ray->t_max); }

  /// Makes `hit` the best hit if BvhTracer's rule prefers it. `instance` is 0 for a one-level BVH.
  void update_best_hit(const Hit& hit, std::uint32_t instance) {
    const float band = kTieOfDistance * best.t + tie;
    const Rank offered = rank_of(instance, hit.triangle);
    const bool better =
        !best.is_hit() || hit.t < best.t - band || (hit.t <= best.t + band && offered.comes_before(rank));
    if (!better) return;
    best = hit;
    rank = offered;
  }
};

/// Filter function that Embree calls for every hit. Compares the hit with the best hit so far, and shortens the ray to
/// the tie distance.
void keep_best_hit(const RTCFilterFunctionNArguments* arguments) {
  assert(arguments->N == 1);
  auto& query = *reinterpret_cast<Query*>(arguments->context);
  auto& ray = *reinterpret_cast<RTCRay*>(arguments->ray);
  const auto& hit = *reinterpret_cast<const RTCHit*>(arguments->hit);
  const bool levels = query.image->has_two_levels();
  const std::uint32_t instance = levels ? hit.instID[0] : 0;
  const std::uint32_t first = levels ? query.image->trees[query.image->tree_of[instance]].first_triangle : 0;
  if (!query.is_face_visible(instance, first + hit.primID)) {
    arguments->valid[0] = 0;  // rejects the hit; Embree continues
    return;
  }
  query.update_best_hit({ray.tfar, hit.u, hit.v, first + hit.primID}, instance);
  ray.tfar = query.tie_limit();
}

RTCRay embree_ray(const Ray& ray) {
  RTCRay r{};
  r.org_x = ray.origin.x, r.org_y = ray.origin.y, r.org_z = ray.origin.z;
  r.dir_x = ray.direction.x, r.dir_y = ray.direction.y, r.dir_z = ray.direction.z;
  r.tnear = ray.t_min;
  r.tfar = ray.t_max;
  r.mask = 0xffffffffU;
  return r;
}

/// Function that Embree calls during the build; returning false cancels the build.
bool continue_commit(void* stop, double) { return !(*static_cast<const sim::Stop*>(stop))(); }

}  // namespace

struct EmbreeTracer::Impl {
  Impl(const MemoryImage& image, unsigned threads, sim::Stop stop);
  /// Adds triangles [first, first + count) of the memory image to an Embree scene.
  void attach_triangles(RTCScene scene, std::size_t first, std::size_t count) const;
  void attach_instances();
  Hit find_nearest(const Ray& ray) const;
  bool is_blocked(const Ray& ray) const;

  const MemoryImage& image_;
  bool is_single_sided_;
  bool has_flags_;
  float diagonal_;
  EmbreeDevice device_;
  std::vector<EmbreeScene> objects_;  ///< one Embree scene per tree of the image
  EmbreeScene scene_;
};

EmbreeTracer::Impl::Impl(const MemoryImage& image, unsigned threads, sim::Stop stop)
    : image_(image),
      is_single_sided_(image.has_single_sided()),
      has_flags_(std::ranges::any_of(image.triangles, [](const TriangleRecord& t) { return t.hit_flags() != 0; })),
      diagonal_(image.diagonal()),
      device_(open_embree(kInstructionSet + ",threads=" + std::to_string(threads))),
      scene_(rtcNewScene(device_.get())) {
  rtcSetSceneFlags(scene_.get(), RTC_SCENE_FLAG_ROBUST);
  if (image.has_two_levels()) {
    attach_instances();
  } else if (!image.triangles.empty()) {
    attach_triangles(scene_.get(), 0, image.triangles.size());
  }
  if (stop != nullptr) rtcSetSceneProgressMonitorFunction(scene_.get(), continue_commit, &stop);
  rtcCommitScene(scene_.get());
  if (stop != nullptr && stop()) throw sim::Cancelled{};
  check_embree(device_.get(), "building the reference tree");
}

void EmbreeTracer::Impl::attach_triangles(RTCScene scene, std::size_t first, std::size_t count) const {
  const EmbreeGeometry geometry(rtcNewGeometry(device_.get(), RTC_GEOMETRY_TYPE_TRIANGLE));
  // Embree reads a triangle record as four vertices. No triangle uses the fourth, which contains the record's integers.
  // The last vertex of the array is omitted, because Embree reads 16 bytes per vertex.
  static_assert(sizeof(TriangleRecord) == 4 * sizeof(glm::vec3) && offsetof(TriangleRecord, v2) == 24);
  rtcSetSharedGeometryBuffer(geometry.get(), RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, &image_.triangles[first], 0,
                             sizeof(glm::vec3), 4 * count - 1);
  auto* corners = static_cast<std::uint32_t*>(rtcSetNewGeometryBuffer(
      geometry.get(), RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 3 * sizeof(std::uint32_t), count));
  check_embree(device_.get(), "taking over the triangles");
  for (std::uint32_t i = 0; i < count; ++i) {
    for (std::uint32_t corner = 0; corner < 3; ++corner) *corners++ = 4 * i + corner;
  }
  rtcSetGeometryIntersectFilterFunction(geometry.get(), keep_best_hit);
  rtcCommitGeometry(geometry.get());
  rtcAttachGeometry(scene, geometry.get());
}

void EmbreeTracer::Impl::attach_instances() {
  for (const ObjectTree& tree : image_.trees) {
    const EmbreeScene& object = objects_.emplace_back(rtcNewScene(device_.get()));
    rtcSetSceneFlags(object.get(), RTC_SCENE_FLAG_ROBUST);
    attach_triangles(object.get(), tree.first_triangle, tree.triangles);
    rtcCommitScene(object.get());
    check_embree(device_.get(), "building the reference tree of a mesh");
  }
  for (std::uint32_t i = 0; i < image_.instances.size(); ++i) {
    if (image_.tree_of[i] == kNone) continue;
    const auto& m = image_.instances[i].to_object;
    glm::dmat4 to_object(1);
    for (int row = 0; row < 3; ++row) {
      for (int column = 0; column < 4; ++column) to_object[column][row] = m[row][column];
    }
    const glm::mat4 to_world(glm::inverse(to_object));
    const EmbreeGeometry geometry(rtcNewGeometry(device_.get(), RTC_GEOMETRY_TYPE_INSTANCE));
    rtcSetGeometryInstancedScene(geometry.get(), objects_[image_.tree_of[i]].get());
    rtcSetGeometryTransform(geometry.get(), 0, RTC_FORMAT_FLOAT4X4_COLUMN_MAJOR, &to_world[0][0]);
    rtcCommitGeometry(geometry.get());
    rtcAttachGeometryByID(scene_.get(), geometry.get(), i);
    check_embree(device_.get(), "placing an instance");
  }
}

Hit EmbreeTracer::Impl::find_nearest(const Ray& ray) const {
  Query query;
  query.image = &image_;
  query.ray = &ray;
  query.is_single_sided = is_single_sided_;
  query.tie = kTieOfDiagonal * diagonal_ / glm::length(ray.direction);
  rtcInitRayQueryContext(&query.context);
  RTCRayHit r{embree_ray(ray), {}};
  r.hit.geomID = RTC_INVALID_GEOMETRY_ID;
#if RTC_VERSION_MAJOR < 4
  rtcIntersect1(scene_.get(), &query.context, &r);
#else
  RTCIntersectArguments arguments;
  rtcInitIntersectArguments(&arguments);
  arguments.context = &query.context;
  rtcIntersect1(scene_.get(), &r, &arguments);
#endif
  if (!query.best.is_hit()) return query.best;
  query.best.triangle |= image_.triangles[query.best.triangle].hit_flags();
  return image_.has_two_levels() ? with_instance(query.best, query.rank.instance) : query.best;
}

bool EmbreeTracer::Impl::is_blocked(const Ray& ray) const {
  RTCRayQueryContext context;
  rtcInitRayQueryContext(&context);
  RTCRay r = embree_ray(ray);
#if RTC_VERSION_MAJOR < 4
  rtcOccluded1(scene_.get(), &context, &r);
#else
  RTCOccludedArguments arguments;
  rtcInitOccludedArguments(&arguments);
  arguments.context = &context;
  rtcOccluded1(scene_.get(), &r, &arguments);
#endif
  return r.tfar < 0;
}

EmbreeTracer::EmbreeTracer(const MemoryImage& image, unsigned threads, sim::Stop stop)
    : impl_(std::make_unique<Impl>(image, threads, stop)) {}
EmbreeTracer::~EmbreeTracer() = default;

void EmbreeTracer::trace(std::span<const Ray> rays, RayKind kind, std::span<Hit> hits, WalkSink*) const {
  assert(hits.size() == rays.size());
  for (std::size_t i = 0; i < rays.size(); ++i) {
    if (kind == RayKind::kShadow && !impl_->has_flags_ && !impl_->is_single_sided_) {
      hits[i] = impl_->is_blocked(rays[i]) ? Hit{rays[i].t_min, 0, 0, 0} : Hit{};
    } else {
      hits[i] = impl_->find_nearest(rays[i]);
    }
  }
}

std::string embree_version() { return RTC_VERSION_STRING; }

}  // namespace traces
