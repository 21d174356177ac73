#include "traces/scene/animation.h"

#include <algorithm>

#include "traces/scene/scene.h"

namespace traces {

Moved pose(Scene& /*scene*/, double /*seconds*/) { return {}; }

double duration(const Scene& scene) {
  float last = 0;
  for (const Track& track : scene.tracks) last = std::max(last, track.times.empty() ? 0.0F : track.times.back());
  return static_cast<double>(last);
}

}  // namespace traces
