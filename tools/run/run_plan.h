#pragma once
#include <cstdint>
#include <optional>
#include <variant>

#include "shader_kernels/programs/program_spec.h"
#include "tools/run/frame/job_options.h"
#include "tools/sampling/tile_sampling.h"

namespace tools {

/// Every tile of a frame is timed on one machine.
struct Whole {
  std::optional<kernels::ProgramSpec> reference;  ///< program of a second run to compare with
  std::uint32_t replicates = 1;                   ///< plays of each frame's work, all but the first perturbed
  bool debug_images = false;
};

/// The tiles of a frame are cut into slices that run side by side on machines of their own (docs/slices.md).
struct Sliced {
  std::uint32_t slices = 1;  ///< or kAutoSlices
};

/// What a run simulates and how. A combination that cannot be simulated has no value.
struct RunPlan {
  kernels::ProgramSpec program;
  std::variant<Whole, TileSampling, Sliced> how;

  const Whole* whole() const { return std::get_if<Whole>(&how); }
  const TileSampling* sampling() const { return std::get_if<TileSampling>(&how); }
  const Sliced* sliced() const { return std::get_if<Sliced>(&how); }
};

/// The plan of the options of `raywatt run`. InputError for options that do not go together.
RunPlan make_plan(const JobOptions& options);

}  // namespace tools
