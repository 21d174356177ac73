#pragma once
#include <optional>

#include "tools/run/frame/load_config.h"
#include "tools/run/frame/run_job.h"

namespace tools {

/// Returns the cost of a frame's denoiser; nothing without one. Kernels: the time from the end of the frame's last
/// other entry to the end of the frame, and what the entries that run its kernels are charged with. They need a frame
/// with itemised costs.
std::optional<DenoiseCost> denoise_cost(const FrameResult& frame, const RunConfig& config);

}  // namespace tools
