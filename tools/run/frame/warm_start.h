#pragma once
#include <cstdint>

#include "hw_models/machines/gpu.h"
#include "shader_kernels/programs/wavefront/frame_program.h"
#include "traces/ray.h"

namespace tools {

/// Warms the caches of a machine, before its first cycle, with the last tiles of `frame`, as if it were the previous
/// frame. A frame of several passes is executed as a whole and must not have been executed before. `workers`: threads
/// in addition to the caller's. Throws Interrupted.
void warm_with_last_tiles(hw::Gpu& gpu, kernels::FrameProgram& frame, const traces::Tracer& tracer,
                          std::uint32_t workers);

}  // namespace tools
