#pragma once
#include <memory>
#include <string>

#include "sim/stop.h"
#include "traces/accel/memory_image.h"
#include "traces/tracer.h"

namespace traces {

/// Ground truth: Embree in its robust mode on the triangles of the memory image, with instances where that has them. It
/// has no canonical walk.
///
/// Distances and weights are Embree's own. Where several triangles lie within rounding of each other along a ray, which
/// Embree would settle by the order it happens to meet them, the one that BvhTracer's rule prefers is taken: the
/// nearest by the triangle test of triangle_test.h, then the lowest `source`. A shadow ray that is blocked reports
/// triangle 0; in a scene with flagged or single-sided triangles, the nearest hit.
class EmbreeTracer : public Tracer {
 public:
  /// `image` must outlive the tracer; `threads` build Embree's tree (0: all there are). sim::Cancelled if `stop` ends
  /// it.
  explicit EmbreeTracer(const MemoryImage& image, unsigned threads = 0, sim::Stop stop = nullptr);
  ~EmbreeTracer() override;
  void trace(std::span<const Ray> rays, RayKind kind, std::span<Hit> hits, WalkSink* walk) const override;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// "3.13.5"
std::string embree_version();

}  // namespace traces
