#pragma once
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "sim/io/json.h"
#include "tools/run/frame/run_job.h"
#include "tools/sampling/slice_player.h"

namespace tools {

/// Selects the number of slices automatically.
inline constexpr std::uint32_t kAutoSlices = 0;

/// Parses "8", or "auto" for kAutoSlices; InputError otherwise.
std::uint32_t parse_slices(const std::string& text);

/// Throws InputError for a program whose frames cannot be split.
void check_slices(const kernels::ProgramSpec& program);

/// Returns the number of slices of a frame. kAutoSlices depends on frame and machine only. InputError if the frame
/// cannot be split into `asked` slices.
std::uint32_t slice_count(const RunConfig& config, const kernels::ProgramSpec& program, std::uint32_t asked);

/// As simulate_frame(), but splits the frame into slices, each simulated on a machine of its own, `threads` at a time
/// (docs/slices.md). The result does not depend on `threads`.
FrameResult simulate_slices(const Inputs& inputs, const kernels::ProgramSpec& program, std::uint32_t threads,
                            std::uint32_t slices, Progress* progress = nullptr);

/// Simulates slice `index` (from 0) of `slices` alone. Returns its results for join_slices().
sim::Json simulate_slice(const Inputs& inputs, const kernels::ProgramSpec& program, std::uint32_t threads,
                         std::uint32_t slices, std::uint32_t index);
/// Joins the results of all slices, in order: the result of simulate_slices() without the picture. InputError if they
/// are not the slices of this frame.
FrameResult join_slices(const Inputs& inputs, const kernels::ProgramSpec& program, std::span<const sim::Json> slices);

/// Returns the slice data of a frame that was simulated as a whole.
SlicedFrame as_single_slice(const FrameResult& s);

/// Joins all slices to a frame: sums of times and counters, and an interval from the differences at borders
/// (docs/slices.md). `function`: results of rendering the frame.
FrameResult sum_slices(const SlicePlayer& player, const kernels::ProgramSpec& program, RenderResult function,
                       std::vector<PlayedSlice> played);

}  // namespace tools
