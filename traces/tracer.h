#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "traces/ray.h"

namespace traces {

/// Destination of canonical walks (walk.h); each ray adds one entry to `begin`.
struct WalkSink {
  std::vector<std::uint32_t>& words;
  std::vector<std::uint32_t>& begin;
};

/// Interface of a tracer. A shadow ray ends at the first triangle without flags (ray.h); if there is none, its hit is
/// the nearest flagged triangle. Any other ray finds its nearest hit.
class Tracer {
 public:
  virtual ~Tracer() = default;
  /// Traces `rays` and writes one entry of `hits` per ray. `walk` may be null; tracers without canonical walks ignore
  /// it.
  virtual void trace(std::span<const Ray> rays, RayKind kind, std::span<Hit> hits, WalkSink* walk) const = 0;
};

}  // namespace traces
