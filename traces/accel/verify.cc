#include "traces/accel/verify.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <limits>
#include <span>
#include <utility>
#include <vector>

#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>

namespace traces {

namespace {

constexpr double kBarycentricMargin = 1e-5;
constexpr double kDiagonalMargin = 1e-6;
constexpr double kIntervalMargin = 1e-5;

Certainty less_certain(Certainty a, Certainty b) { return std::min(a, b); }

/// Classifies a test as certain hit, certain miss or uncertain. `value`: a quantity that is positive for a hit.
/// `margin`: its largest error.
Certainty certainty_of(double value, double margin) {
  if (value < -margin) return Certainty::kMiss;
  return value > margin ? Certainty::kHit : Certainty::kUncertain;
}

/// Transforms points from the mesh's space to the world, in double precision.
struct ToWorld {
  glm::dmat3 linear{1};
  glm::dvec3 origin{0};  ///< origin of the mesh's space
  double handedness = 1;
  glm::dvec3 operator()(const glm::vec3& p) const { return linear * (glm::dvec3(p) - origin); }
};

glm::dmat3 linear_part(const InstanceRecord& instance) {
  const auto& m = instance.to_object;
  return glm::transpose(glm::dmat3(m[0][0], m[0][1], m[0][2], m[1][0], m[1][1], m[1][2], m[2][0], m[2][1], m[2][2]));
}

glm::dvec3 translation_of(const InstanceRecord& instance) {
  return {instance.to_object[0][3], instance.to_object[1][3], instance.to_object[2][3]};
}

ToWorld to_world(const InstanceRecord& instance) {
  return {glm::inverse(linear_part(instance)), translation_of(instance), instance.handedness};
}

/// True if the ray passes near the root boxes of the instance, within about 100 times the margin of uncertain hits.
bool passes_near(const Ray& ray, const MemoryImage& image, const InstanceRecord& instance) {
  const glm::dmat3 linear = linear_part(instance);
  const glm::dvec3 origin = linear * glm::dvec3(ray.origin) + translation_of(instance);
  const glm::dvec3 direction = linear * glm::dvec3(ray.direction);
  const Bounds root = tree_bounds(image, instance.root);
  double enter = -std::numeric_limits<double>::infinity(), leave = -enter;
  for (int axis = 0; axis < 3; ++axis) {
    double stretch = 0;
    for (int column = 0; column < 3; ++column) stretch += std::abs(linear[column][axis]);
    const double margin = 1e-4 * image.diagonal() * stretch;
    const double low = root.lower[axis] - margin, high = root.upper[axis] + margin;
    if (direction[axis] == 0 && (origin[axis] < low || origin[axis] > high)) return false;
    if (direction[axis] == 0) continue;
    const double a = (low - origin[axis]) / direction[axis], b = (high - origin[axis]) / direction[axis];
    enter = std::max(enter, std::min(a, b));
    leave = std::min(leave, std::max(a, b));
  }
  return enter <= leave;
}

/// Classifies whether the face of a triangle on the ray's side exists or is culled. `cosine` is that between the ray
/// and the normal of the counter-clockwise face.
Certainty face_certainty(const TriangleRecord& triangle, double cosine) {
  const bool has_clockwise = (triangle.material & kNoClockwise) == 0;
  const bool has_other = (triangle.material & kNoCounterClockwise) == 0;
  if (has_clockwise && has_other) return Certainty::kHit;
  return certainty_of(has_clockwise ? cosine : -cosine, kBarycentricMargin);
}

ExactHit exact_hit(const Ray& ray, const TriangleRecord& triangle, const ToWorld& world, double diagonal) {
  const glm::dvec3 origin(ray.origin), direction(ray.direction);
  const std::array<glm::dvec3, 3> v{world(triangle.v0), world(triangle.v1), world(triangle.v2)};
  const glm::dvec3 normal = glm::cross(v[1] - v[0], v[2] - v[0]);
  const double slope = glm::dot(normal, direction);
  if (slope == 0) return {};
  const double t = glm::dot(normal, v[0] - origin) / slope;
  const double length_margin = kDiagonalMargin * diagonal;
  const double t_margin = length_margin / glm::length(direction);

  Certainty certainty = certainty_of(t - ray.t_min, kIntervalMargin * ray.t_min + t_margin);
  if (!std::isinf(ray.t_max)) {
    certainty = less_certain(certainty, certainty_of(ray.t_max - t, kIntervalMargin * ray.t_max + t_margin));
  }
  certainty = less_certain(
      certainty, face_certainty(triangle, world.handedness * slope / (glm::length(normal) * glm::length(direction))));
  const glm::dvec3 at = origin + t * direction;
  const double twice_area = glm::length(normal);
  for (std::size_t i = 0; i < 3 && certainty != Certainty::kMiss; ++i) {
    const glm::dvec3 edge = v[(i + 1) % 3] - v[i];
    // distance of the hit from the edge (positive inside the triangle), times the length of the edge
    const double inwards = glm::dot(normal, glm::cross(edge, at - v[i])) / twice_area;
    const double margin = std::max(kBarycentricMargin * twice_area, length_margin * glm::length(edge));
    certainty = less_certain(certainty, certainty_of(inwards, margin));
  }
  return {certainty, t};
}

void test_all_triangles(const Ray& ray, std::span<const TriangleRecord> triangles, const ToWorld& world,
                        double diagonal, ExactTrace& trace) {
  for (const TriangleRecord& triangle : triangles) {
    const ExactHit hit = exact_hit(ray, triangle, world, diagonal);
    if (hit.certainty == Certainty::kMiss) continue;
    trace.any_possible = true;
    if (hit.certainty == Certainty::kHit) trace.nearest = std::min(trace.nearest, hit.t);
  }
}

}  // namespace

ExactHit exact_hit(const Ray& ray, const MemoryImage& image, const Hit& hit) {
  const ToWorld world = image.has_two_levels() ? to_world(image.instances[instance_index_of(hit)]) : ToWorld{};
  return exact_hit(ray, image.triangles[hit.triangle_index()], world, image.diagonal());
}

ExactTrace exact_trace(const Ray& ray, const MemoryImage& image) {
  ExactTrace trace;
  if (!image.has_two_levels()) {
    test_all_triangles(ray, image.triangles, {}, image.diagonal(), trace);
    return trace;
  }
  for (std::size_t i = 0; i < image.instances.size(); ++i) {
    if (image.tree_of[i] == kNone || !passes_near(ray, image, image.instances[i])) continue;
    const ObjectTree& tree = image.trees[image.tree_of[i]];
    test_all_triangles(ray, std::span(image.triangles).subspan(tree.first_triangle, tree.triangles),
                       to_world(image.instances[i]), image.diagonal(), trace);
  }
  return trace;
}

namespace {

constexpr double kRelativeTolerance = 1e-4;
constexpr double kDiagonalTolerance = 1e-5;

}  // namespace

VerifyCounts& VerifyCounts::operator+=(const VerifyCounts& other) {
  rays += other.rays;
  missing_hits += other.missing_hits;
  extra_hits += other.extra_hits;
  distance_errors += other.distance_errors;
  edge_ties += other.edge_ties;
  reference_errors += other.reference_errors;
  return *this;
}

VerifyingTracer::VerifyingTracer(const MemoryImage& image, const Tracer& tested, const Tracer& reference)
    : image_(image), tested_(tested), reference_(reference), diagonal_(image.diagonal()) {}

VerifyCounts VerifyingTracer::verify_counts() const {
  const std::lock_guard lock(mutex_);
  return counts_;
}

bool VerifyingTracer::take_retry() const {
  const std::lock_guard lock(mutex_);
  return retries_++ < kRetries;
}

double VerifyingTracer::distance_tolerance(const Ray& ray, double t) const {
  return kRelativeTolerance * t + kDiagonalTolerance * diagonal_ / glm::length(ray.direction);
}

bool VerifyingTracer::is_same_hit(const Ray& ray, bool any, const Hit& tested, const Hit& reference) const {
  if (tested.is_hit() != reference.is_hit()) return false;
  if (!tested.is_hit()) return true;
  // A reference result with flags does not show whether the ray is blocked. The tested hit itself is then checked.
  if (any) return !reference.is_flagged() || is_possible(ray, tested);
  return tested.triangle == reference.triangle &&
         (!image_.has_two_levels() || instance_index_of(tested) == instance_index_of(reference)) &&
         std::fabs(double{tested.t} - reference.t) <= distance_tolerance(ray, reference.t);
}

bool VerifyingTracer::names_existing_triangle(const Hit& hit) const {
  return hit.triangle_index() < image_.triangles.size() &&
         (!image_.has_two_levels() || instance_index_of(hit) < image_.instances.size());
}

bool VerifyingTracer::is_possible(const Ray& ray, const Hit& hit) const {
  return names_existing_triangle(hit) && exact_hit(ray, image_, hit).certainty != Certainty::kMiss;
}

VerifyingTracer::Verdict VerifyingTracer::judge_in_double_precision(const Ray& ray, bool any, const Hit& tested,
                                                                    const Hit& reference) const {
  const ExactTrace truth = exact_trace(ray, image_);
  const auto allowed = [&](const Hit& hit) {
    if (!hit.is_hit()) return std::isinf(truth.nearest);
    if (any) return hit.is_flagged() || reference.is_flagged() ? is_possible(ray, hit) : truth.any_possible;
    if (!names_existing_triangle(hit)) return false;
    const ExactHit exact = exact_hit(ray, image_, hit);
    const double slack = distance_tolerance(ray, exact.t);
    return exact.certainty != Certainty::kMiss && std::fabs(hit.t - exact.t) <= slack && hit.t <= truth.nearest + slack;
  };
  if (!allowed(tested)) return Verdict::kTestedWrong;
  return allowed(reference) ? Verdict::kTie : Verdict::kReferenceWrong;
}

void VerifyingTracer::trace(std::span<const Ray> rays, RayKind kind, std::span<Hit> hits, WalkSink* walk) const {
  assert(hits.size() == rays.size());
  std::vector<Hit> references(rays.size());
  tested_.trace(rays, kind, hits, walk);
  reference_.trace(rays, kind, references, nullptr);

  VerifyCounts found;
  found.rays = rays.size();
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const Hit& tested = hits[i];
    const Hit& reference = references[i];
    const bool any = accepts_any_hit(kind, tested);
    if (is_same_hit(rays[i], any, tested, reference)) continue;
    const Verdict verdict =
        take_retry() ? judge_in_double_precision(rays[i], any, tested, reference) : Verdict::kTestedWrong;
    if (verdict == Verdict::kTie) {
      ++found.edge_ties;
    } else if (verdict == Verdict::kReferenceWrong) {
      ++found.reference_errors;
    } else if (!tested.is_hit()) {
      ++found.missing_hits;
    } else if (!reference.is_hit()) {
      ++found.extra_hits;
    } else {
      ++found.distance_errors;
    }
  }
  const std::lock_guard lock(mutex_);
  counts_ += found;
}

}  // namespace traces
