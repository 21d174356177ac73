#include "tools/run/run_plan.h"

#include <array>

#include <fmt/format.h>

#include "sim/error.h"
#include "tools/sampling/slices.h"

namespace tools {
namespace {

/// An option that needs whole frames, and why sampling and slices refuse it.
struct OfWholeFrames {
  const char* option;
  bool (*is_given)(const JobOptions& options);
  const char* why_not_sampled;
  const char* why_not_sliced;
};
constexpr std::array<OfWholeFrames, 5> kOfWholeFrames = {{
    {"--reference", [](const JobOptions& o) { return !o.reference.empty(); }, "compare two runs of all tiles",
     "compare two runs with equal --slices"},
    {"--replicates", [](const JobOptions& o) { return o.replicates > 1; }, "replicates play all tiles",
     "replicates are played side by side already"},
    {"--timeline", [](const JobOptions& o) { return !o.timeline.empty(); },
     "a timeline is of a frame whose tiles are all timed", "a timeline is of one machine"},
    {"--record", [](const JobOptions& o) { return !o.record.empty(); }, "a trace has all tiles",
     "slices render tiles at their borders twice"},
    {"--debug-images", [](const JobOptions& o) { return o.debug_images; }, "they show what all tiles took",
     "what a tile took is that of one machine"},
}};

void refuse_options_of_whole_frames(const JobOptions& options, const char* mode, const char* OfWholeFrames::*why) {
  for (const OfWholeFrames& each : kOfWholeFrames) {
    if (each.is_given(options))
      throw sim::InputError(fmt::format("{} does not go with {}: {}", mode, each.option, each.*why));
  }
}

}  // namespace

RunPlan make_plan(const JobOptions& options) {
  RunPlan plan{kernels::parse_program(options.program), Whole{}};
  const bool is_sampled = !options.tile_sampling.empty(), is_sliced = !options.slices.empty();
  if (is_sampled) {
    check_tile_sampling(plan.program);
    refuse_options_of_whole_frames(options, "--tile-sampling", &OfWholeFrames::why_not_sampled);
    plan.how = parse_tile_sampling(options.tile_sampling, options.image);
  } else if (options.image != "full") {
    throw sim::InputError("--image none goes with --tile-sampling only");
  }
  if (is_sliced) {
    const std::uint32_t slices = parse_slices(options.slices);
    check_slices(plan.program);
    if (is_sampled) {
      throw sim::InputError("--slices does not go with --tile-sampling: a sample of the tiles is not cut");
    }
    refuse_options_of_whole_frames(options, "--slices", &OfWholeFrames::why_not_sliced);
    plan.how = Sliced{slices};
  }
  if (!is_sampled && !is_sliced) {
    Whole whole{{}, options.replicates, options.debug_images};
    if (!options.reference.empty()) whole.reference = kernels::parse_program(options.reference);
    plan.how = whole;
  }
  return plan;
}

}  // namespace tools
