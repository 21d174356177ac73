#pragma once
#include <memory>
#include <string>

#include "sim/error.h"
#include "traces/accel/memory_image.h"
#include "traces/ray.h"

namespace traces {

/// Reference tracer: Embree in robust mode on the triangles of the memory image, with its instances. It records no
/// canonical walks.
///
/// 1. Distances and weights are Embree's own.
/// 2. Of triangles within rounding error of each other along a ray, it returns the triangle that BvhTracer prefers: the
///    nearest by the test of ray_tests.h, then the lowest `source`. Embree alone would return the triangle
///    that it meets first.
/// 3. The hit of a blocked shadow ray names triangle 0. In a scene with flagged (ray.h) or single-sided triangles it is
///    the nearest hit.
class EmbreeTracer : public Tracer {
 public:
  /// Builds Embree's tree on `threads` threads (0: all). `image` must outlive the tracer. Throws sim::Cancelled if
  /// `stop` returns true.
  explicit EmbreeTracer(const MemoryImage& image, unsigned threads = 0, sim::Stop stop = nullptr);
  ~EmbreeTracer() override;
  void trace(std::span<const Ray> rays, RayKind kind, std::span<Hit> hits, WalkSink* walk) const override;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Returns the version of the Embree library, such as "3.13.5".
std::string embree_version();

}  // namespace traces
