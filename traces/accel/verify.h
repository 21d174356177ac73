#pragma once
#include <cstdint>
#include <mutex>

#include "traces/accel/memory_image.h"
#include "traces/tracer.h"

namespace traces {

/// Result of tracing rays twice. The first three are faults of the tested tracer; all is well when they are 0.
struct VerifyCounts {
  std::uint64_t rays = 0;
  std::uint64_t missing_hits = 0;      ///< the reference hits, the tested tracer does not
  std::uint64_t extra_hits = 0;        ///< the other way round
  std::uint64_t distance_errors = 0;   ///< both hit, but another triangle or at another distance
  std::uint64_t edge_ties = 0;         ///< they differ where double precision allows either
  std::uint64_t reference_errors = 0;  ///< they differ and double precision allows only the tested tracer's answer

  VerifyCounts& operator+=(const VerifyCounts& other);
  std::uint64_t faults() const { return missing_hits + extra_hits + distance_errors; }
};

/// Traces every ray with two tracers, returns the tested one's hits and walks, and counts where they differ: hit or
/// miss, and for nearest hits the triangle and the distance (within 1e-4 t + 1e-5 of the scene's diagonal). A shadow
/// ray's hit is held to that if it is flagged; if not, double precision must allow a hit of the triangle that it names.
/// Each difference is tried again in double precision against every triangle; after kRetries of them, which a
/// working tracer never has, differences count as faults untried. Several threads may trace at once.
class VerifyingTracer : public Tracer {
 public:
  static constexpr std::uint64_t kRetries = 4096;

  /// All three must outlive this tracer.
  VerifyingTracer(const MemoryImage& image, const Tracer& tested, const Tracer& reference);
  void trace(std::span<const Ray> rays, RayKind kind, std::span<Hit> hits, WalkSink* walk) const override;
  VerifyCounts counts() const;

 private:
  enum class Verdict { kTie, kReferenceWrong, kTestedWrong };

  /// Kind of query that a hit answers: "something is there" or "this is the nearest".
  static bool is_any(RayKind kind, const Hit& tested) { return kind == RayKind::kShadow && !tested.is_flagged(); }
  bool alike(const Ray& ray, bool any, const Hit& tested, const Hit& reference) const;
  /// Does it name what the scene has?
  bool is_there(const Hit& hit) const;
  bool is_possible(const Ray& ray, const Hit& hit) const;
  Verdict retry(const Ray& ray, bool any, const Hit& tested, const Hit& reference) const;
  double tolerance(const Ray& ray, double t) const;
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
