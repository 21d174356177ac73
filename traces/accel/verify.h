#pragma once
#include <cstdint>
#include <limits>
#include <mutex>

#include "traces/accel/memory_image.h"
#include "traces/ray.h"

namespace traces {

/// Whether a ray hits a triangle, computed in double precision. kUncertain: the hit is so close to an edge of the
/// triangle or to an end of the ray that single precision may decide either way. The margin is 1e-5 (of barycentric
/// weights or of the distance) or 1e-6 of the scene's diagonal.
enum class Certainty { kMiss, kUncertain, kHit };

struct ExactHit {
  Certainty certainty = Certainty::kMiss;
  double t = std::numeric_limits<double>::infinity();
};

/// Tests a ray in double precision against the triangle and instance that `hit` names, which must exist.
ExactHit exact_hit(const Ray& ray, const MemoryImage& image, const Hit& hit);

/// Result of testing a ray in double precision against all triangles of the scene. In a two-level BVH, instances far
/// from the ray are skipped.
struct ExactTrace {
  double nearest = std::numeric_limits<double>::infinity();  ///< distance of the nearest certain hit
  bool any_possible = false;                                 ///< some hit is certain or uncertain
};

ExactTrace exact_trace(const Ray& ray, const MemoryImage& image);

/// How the results of two tracers for the same rays differ. The first three counts are errors of the tested tracer.
struct VerifyCounts {
  std::uint64_t rays = 0;
  std::uint64_t missing_hits = 0;      ///< only the reference tracer found a hit
  std::uint64_t extra_hits = 0;        ///< only the tested tracer found a hit
  std::uint64_t distance_errors = 0;   ///< both found a hit, with different triangles or distances
  std::uint64_t edge_ties = 0;         ///< the results differ, and double precision allows either
  std::uint64_t reference_errors = 0;  ///< the results differ, and double precision confirms the tested tracer

  VerifyCounts& operator+=(const VerifyCounts& other);
  std::uint64_t error_count() const { return missing_hits + extra_hits + distance_errors; }
};

/// Traces every ray with two tracers, returns the hits and walks of the tested one, and counts differences.
///
/// 1. Nearest hits are compared by triangle and distance (within 1e-4 t + 1e-5 of the scene's diagonal). So are flagged
///    hits of shadow rays.
/// 2. For any other hit of a shadow ray, double precision must confirm the named triangle.
/// 3. Each difference is tested again in double precision against all triangles. After kRetries differences, which a
///    correct tracer never reaches, the rest count as errors without that test.
/// 4. Several threads may trace at once.
class VerifyingTracer : public Tracer {
 public:
  static constexpr std::uint64_t kRetries = 4096;

  /// The image and both tracers must outlive this tracer.
  VerifyingTracer(const MemoryImage& image, const Tracer& tested, const Tracer& reference);
  void trace(std::span<const Ray> rays, RayKind kind, std::span<Hit> hits, WalkSink* walk) const override;
  const RayPredictor* ray_predictor() const override { return tested_.ray_predictor(); }
  VerifyCounts verify_counts() const;

 private:
  enum class Verdict { kTie, kReferenceWrong, kTestedWrong };

  /// True if any hit is a correct result for the ray, false if only the nearest hit is.
  static bool accepts_any_hit(RayKind kind, const Hit& tested) {
    return kind == RayKind::kShadow && !tested.is_flagged();
  }
  bool is_same_hit(const Ray& ray, bool any, const Hit& tested, const Hit& reference) const;
  /// True if the triangle and instance that the hit names exist.
  bool names_existing_triangle(const Hit& hit) const;
  bool is_possible(const Ray& ray, const Hit& hit) const;
  Verdict judge_in_double_precision(const Ray& ray, bool any, const Hit& tested, const Hit& reference) const;
  double distance_tolerance(const Ray& ray, double t) const;
  bool take_retry() const;

  const MemoryImage& image_;
  const Tracer& tested_;
  const Tracer& reference_;
  const double diagonal_;
  mutable std::mutex mutex_;
  mutable VerifyCounts counts_;
  mutable std::uint64_t retries_ = 0;
};

}  // namespace traces
