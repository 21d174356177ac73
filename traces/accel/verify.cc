#include "traces/accel/verify.h"

#include <cassert>
#include <cmath>
#include <vector>

#include <glm/geometric.hpp>

#include "traces/accel/exact.h"

namespace traces {
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

VerifyCounts VerifyingTracer::counts() const {
  const std::lock_guard lock(mutex_);
  return counts_;
}

bool VerifyingTracer::take_retry() const {
  const std::lock_guard lock(mutex_);
  return retries_++ < kRetries;
}

double VerifyingTracer::tolerance(const Ray& ray, double t) const {
  return kRelativeTolerance * t + kDiagonalTolerance * diagonal_ / glm::length(ray.direction);
}

bool VerifyingTracer::alike(const Ray& ray, bool any, const Hit& tested, const Hit& reference) const {
  if (tested.is_hit() != reference.is_hit()) return false;
  if (!tested.is_hit()) return true;
  // A reference that stopped at a flagged triangle gives no answer; test the hit itself.
  if (any) return !reference.is_flagged() || is_possible(ray, tested);
  return tested.triangle == reference.triangle &&
         (!image_.has_levels() || instance_of(tested) == instance_of(reference)) &&
         std::fabs(double{tested.t} - reference.t) <= tolerance(ray, reference.t);
}

bool VerifyingTracer::is_there(const Hit& hit) const {
  return hit.index() < image_.triangles.size() && (!image_.has_levels() || instance_of(hit) < image_.instances.size());
}

bool VerifyingTracer::is_possible(const Ray& ray, const Hit& hit) const {
  return is_there(hit) && exact_hit(ray, image_, hit).standing != Standing::kMiss;
}

VerifyingTracer::Verdict VerifyingTracer::retry(const Ray& ray, bool any, const Hit& tested,
                                                const Hit& reference) const {
  const ExactTrace truth = exact_trace(ray, image_);
  const auto allowed = [&](const Hit& hit) {
    if (!hit.is_hit()) return std::isinf(truth.nearest);
    if (any) return hit.is_flagged() || reference.is_flagged() ? is_possible(ray, hit) : truth.any_possible;
    if (!is_there(hit)) return false;
    const ExactHit exact = exact_hit(ray, image_, hit);
    const double slack = tolerance(ray, exact.t);
    return exact.standing != Standing::kMiss && std::fabs(hit.t - exact.t) <= slack && hit.t <= truth.nearest + slack;
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
    const bool any = is_any(kind, tested);
    if (alike(rays[i], any, tested, reference)) continue;
    const Verdict verdict = take_retry() ? retry(rays[i], any, tested, reference) : Verdict::kTestedWrong;
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
