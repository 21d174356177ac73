#pragma once
#include "traces/accel/memory_image.h"
#include "traces/tracer.h"

namespace traces {

/// Functional traversal of the memory image, and the only tracer that records canonical walks (walk.h).
///
/// The root's boxes are tested first. Of two boxes hit, the one entered earlier is near (child 0 if equal); the far one
/// is pushed with its entry distance and dropped when popped if that lies behind the hit so far. The nearest hit wins,
/// and of hits at equal distance the triangle with the lowest `source`. Rays start at t_min >= 0.
///
/// A shadow ray's walk ends at once at a triangle without flags. A flagged one becomes the nearest candidate, behind
/// which nothing is of interest, and the walk goes on; the answer is the candidate if nothing ends the walk.
class BvhTracer : public Tracer {
 public:
  /// Both give the same bits; kPortable is there for other processors and to prove it.
  enum class Arithmetic { kNative, kPortable };

  /// `image` must outlive the tracer.
  explicit BvhTracer(const MemoryImage& image, Arithmetic arithmetic = Arithmetic::kNative);
  void trace(std::span<const Ray> rays, RayKind kind, std::span<Hit> hits, WalkSink* walk) const override;

 private:
  const MemoryImage& image_;
  Arithmetic arithmetic_;
};

}  // namespace traces
