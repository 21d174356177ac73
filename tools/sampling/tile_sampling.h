#pragma once
#include <cstdint>
#include <string>

#include "tools/run/frame/run_job.h"

namespace tools {

/// Parameters of sampling (--tile-sampling, --image).
struct TileSampling {
  double share = 0.05;  ///< share of the frame's work to measure
  double target = 0;  ///< --tile-sampling auto: blocks are added until both relative half-widths are below this; 0: off
  bool full_image = true;  ///< render all tiles, including those that are not simulated
};

/// Parses "5%" or "auto", "full" or "none"; InputError otherwise.
TileSampling parse_tile_sampling(const std::string& sampling, const std::string& image);

/// Throws InputError for a program whose tiles cannot be sampled.
void check_tile_sampling(const kernels::ProgramSpec& program);

/// As simulate(), but simulates some tiles and estimates the rest from them (docs/sampling.md).
FrameResult simulate_sampled(const Inputs& inputs, const kernels::ProgramSpec& program, std::uint32_t threads,
                             const TileSampling& sampling, Progress* progress = nullptr);

}  // namespace tools
