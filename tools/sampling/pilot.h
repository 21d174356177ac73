#pragma once
#include <cmath>
#include <cstdint>
#include <vector>

#include "tools/run/frame/run_job.h"
#include "tools/sampling/tile_pilot.h"

namespace tools {

/// Survey of all tiles of a frame from a picture with one of `thinning` samples.
struct Pilot {
  std::vector<TileTraits> traits;  ///< one per tile of the frame
  std::vector<double> costs;
  double thinning = 1;
  FrontEnd::Result function;
};

/// Returns the side of a tile of the frame in samples.
std::uint32_t tile_side(const kernels::RenderConfig& render, const kernels::ProgramSpec& spec);

/// Renders the thin picture and computes traits and cost of every tile.
Pilot look_at_all(const Inputs& inputs, const kernels::ProgramSpec& spec, const traces::Tracer& tracer,
                  std::uint32_t threads, Progress* progress);

/// Estimates the relative host cost of each tile from a still thinner picture.
std::vector<double> guess_costs(const Inputs& inputs, const kernels::ProgramSpec& spec, const traces::Tracer& tracer,
                                std::uint32_t threads);

/// Scales the counts of the pilot to the whole frame.
FrontEnd::Result scaled(const Pilot& pilot, const Inputs& inputs, const kernels::ProgramSpec& spec);

inline std::uint64_t rounded(double x) { return static_cast<std::uint64_t>(std::llround(x)); }

}  // namespace tools
