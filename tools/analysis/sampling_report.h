#pragma once
#include <optional>

#include "tools/run/frame/run_job.h"

namespace tools {

/// Purposes of kernels whose time papers report separately. Checks include the compaction of results into streams.
enum class KernelGroup : std::uint8_t { kTracing, kCheck, kInterpolation, kCorrection };

/// Returns the share of the shader cores' busy cycles; nullopt if they were never busy.
std::optional<double> kernel_share(const FrameResult& run, KernelGroup group);

/// Returns the share of time in which a core's T&I unit has no rays while its SRP runs checks or interpolation.
std::optional<double> starved_share(const FrameResult& run);

}  // namespace tools
