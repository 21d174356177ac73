#pragma once
#include <cstdint>
#include <optional>
#include <variant>

#include "shader_kernels/programs/program_spec.h"
#include "tools/run/frame/job_options.h"
#include "tools/sampling/tile_sampling.h"

namespace tools {

/// Every tile of a frame is simulated on one machine.
struct Whole {
  std::optional<kernels::ProgramSpec> reference;  ///< program of the reference run, if any
  std::uint32_t replicates = 1;                   ///< simulations of each frame; all but the first are perturbed
  bool debug_images = false;
};

/// The tiles of a frame are split into slices, simulated concurrently on machines of their own (docs/slices.md).
struct Sliced {
  std::uint32_t slices = 1;  ///< or kAutoSlices
};

/// What a run simulates and how. Invalid combinations of options cannot be represented.
struct RunPlan {
  kernels::ProgramSpec program;
  std::variant<Whole, TileSampling, Sliced> how;

  const Whole* whole() const { return std::get_if<Whole>(&how); }
  const TileSampling* sampling() const { return std::get_if<TileSampling>(&how); }
  const Sliced* sliced() const { return std::get_if<Sliced>(&how); }
};

/// Returns the plan of the options of `raywatt run`. InputError for options that exclude each other.
RunPlan make_plan(const JobOptions& options);

}  // namespace tools
