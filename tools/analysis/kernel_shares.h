#pragma once
#include <optional>

#include "tools/run/frame/run_job.h"

namespace tools {

/// Purposes of kernels, where papers count the time of some of them apart.
/// Checks pack what passed and what failed into streams.
enum class KernelGroup : std::uint8_t { kTracing, kCheck, kInterpolation, kCorrection };

/// Share of the shader cores' busy cycles; nothing if they were never busy.
std::optional<double> kernel_share(const FrameResult& simulation, KernelGroup group);

/// Part of the time for which the T&I units have no rays while checks or interpolation run on their core.
std::optional<double> starved_share(const FrameResult& simulation);

}  // namespace tools
