#pragma once
#include <optional>

#include "traces/accel/memory_image.h"
#include "traces/accel/ray_predictor.h"
#include "traces/ray.h"

namespace traces {

/// Functional tracer that traverses the memory image; the only one that records canonical walks (walk.h).
///
/// 1. The boxes of the root are tested first. If a ray hits both boxes of a node, the near child is the first that it
/// enters (child 0 if equal).
/// 2. The far child is pushed with its entry distance. A popped entry is dropped if it begins beyond the current hit.
/// 3. The nearest hit wins; of hits at equal distance, the triangle with the lowest `source`.
/// 4. A shadow ray's walk ends at the first hit of an opaque triangle. A hit of a triangle with flags (alpha-tested or
/// transparent) becomes the candidate and limits the ray, and the walk continues. The candidate is the result if no hit
/// ends the walk.
///
/// 5. With a predictor, a recorded shadow ray first visits the subtree that its look-up finds, where it accepts opaque
/// triangles only. If none blocks it, the whole walk follows. So whether a ray is blocked never depends on the table.
///
/// Rays must start at t_min >= 0.
class BvhTracer : public Tracer {
 public:
  /// Which instructions the tracer uses. kNative and kPortable give the same bits; kPortable serves other processors
  /// and tests of kNative.
  enum class Arithmetic { kNative, kPortable };

  /// `image` must outlive the tracer.
  explicit BvhTracer(const MemoryImage& image, Arithmetic arithmetic = Arithmetic::kNative);
  /// A tracer with a predictor, if the configuration enables it.
  BvhTracer(const MemoryImage& image, const PredictorConfig& predictor);
  void trace(std::span<const Ray> rays, RayKind kind, std::span<Hit> hits, WalkSink* walk) const override;
  const RayPredictor* ray_predictor() const override { return predictor_ ? &*predictor_ : nullptr; }

 private:
  const MemoryImage& image_;
  Arithmetic arithmetic_;
  std::optional<RayPredictor> predictor_;
};

}  // namespace traces
