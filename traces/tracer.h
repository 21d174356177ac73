#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "traces/ray.h"

namespace traces {

/// Where a tracer writes the canonical walks (walk.h): `begin` gets one entry per ray.
struct WalkSink {
  std::vector<std::uint32_t>& words;
  std::vector<std::uint32_t>& begin;
};

/// Finds hits. Shadow rays ask "anything?" and stop at the first triangle without flags (ray.h); where there is none
/// they report the nearest flagged one. All others want the nearest of all.
class Tracer {
 public:
  virtual ~Tracer() = default;
  /// `hits` is as long as `rays`. `walk` may be null; a tracer that has no canonical walk ignores it.
  virtual void trace(std::span<const Ray> rays, RayKind kind, std::span<Hit> hits, WalkSink* walk) const = 0;
};

}  // namespace traces
