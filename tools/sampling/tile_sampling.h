#pragma once
#include <cstdint>
#include <string>

#include "tools/run/frame/run_job.h"

namespace tools {

/// How a frame is sampled (--tile-sampling, --image).
struct TileSampling {
  double share = 0.05;     ///< part of the frame's work that is measured
  double target = 0;       ///< --tile-sampling auto: blocks are added until both intervals are within this; 0: no
  bool full_image = true;  ///< all tiles are rendered, if not timed
};

/// "5%" or "auto", "full" or "none"; InputError otherwise.
TileSampling parse_tile_sampling(const std::string& sampling, const std::string& image);

/// InputError that says why, for a program whose tiles cannot be sampled.
void check_tile_sampling(const kernels::ProgramSpec& program);

/// As simulate(), with some of the frame's tiles timed and the rest estimated from them (docs/sampling.md).
FrameResult simulate_sampled(const Inputs& inputs, const kernels::ProgramSpec& program, std::uint32_t threads,
                             const TileSampling& sampling, Progress* progress = nullptr);

}  // namespace tools
