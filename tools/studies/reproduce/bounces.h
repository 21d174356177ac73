#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "tools/run/frame/run_job.h"
#include "traces/ray.h"

namespace tools::reproduce {

/// Rays of all paths of a frame after the same number of bounces, in the order in which tiles make them.
struct BounceRays {
  std::vector<traces::Ray> paths;    ///< rays that find the next surface: those of the camera in bounce 0
  std::vector<traces::Ray> shadows;  ///< shadow and occlusion rays from these surfaces
};

/// Renders a frame and returns its rays by bounce. In each tile a bounce begins with the first ray that is no shadow
/// ray after shadow rays or after the camera's rays.
std::vector<BounceRays> record_bounces(const Inputs& inputs, const kernels::ProgramSpec& program);

/// Result of a list of rays that T&I units traverse without shader cores.
struct PlayedRays {
  std::vector<sim::UnitReport> units;
  std::uint64_t cycles = 0;
};
PlayedRays play_rays(const Inputs& inputs, std::span<const traces::Ray> rays, traces::RayKind kind);

/// Returns the mean number of distinct lines of nodes that 1,000 consecutive rays read. It does not depend on the
/// machine.
double lines_per_thousand_rays(const Inputs& inputs, std::span<const traces::Ray> rays, traces::RayKind kind);

}  // namespace tools::reproduce
