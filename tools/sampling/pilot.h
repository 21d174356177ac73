#pragma once
#include <cmath>
#include <cstdint>
#include <vector>

#include "tools/run/frame/run_job.h"
#include "tools/sampling/tile_pilot.h"

namespace tools {

/// A thin picture, all of whose tiles are looked at: one of `thinning` samples of each of the frame's.
struct Pilot {
  std::vector<TileTraits> traits;  ///< one of each of the frame's tiles
  std::vector<double> costs;
  double thinning = 1;
  FrontEnd::Result function;
};

/// Side of a tile of the frame, in samples.
std::uint32_t tile_side(const kernels::RenderConfig& render, const kernels::ProgramSpec& spec);

/// Renders the thin picture and looks at every tile.
Pilot look_at_all(const Inputs& inputs, const kernels::ProgramSpec& spec, const traces::Tracer& tracer,
                  std::uint32_t threads, Progress* progress);

/// Guesses at what each of the frame's tiles will cost the host, as parts of each other, from a thinner picture.
std::vector<double> guess_costs(const Inputs& inputs, const kernels::ProgramSpec& spec, const traces::Tracer& tracer,
                                std::uint32_t threads);

/// Estimate of the frame's function from the pilot's.
FrontEnd::Result scaled(const Pilot& pilot, const Inputs& inputs, const kernels::ProgramSpec& spec);

inline std::uint64_t rounded(double x) { return static_cast<std::uint64_t>(std::llround(x)); }

}  // namespace tools
