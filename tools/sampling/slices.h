#pragma once
#include <cstdint>
#include <span>
#include <string>

#include "sim/io/json.h"
#include "tools/run/frame/run_job.h"

namespace tools {

/// Number of slices that stands for as many as suit the frame.
inline constexpr std::uint32_t kAutoSlices = 0;

/// "8", or "auto" for kAutoSlices; InputError otherwise.
std::uint32_t parse_slices(const std::string& text);

/// InputError that says why, for a program whose frames cannot be cut.
void check_slices(const kernels::ProgramSpec& program);

/// Slices that a frame of this configuration is cut into where `asked` for so many. kAutoSlices depends on the frame
/// and the machine alone. InputError for a frame that cannot be cut so.
std::uint32_t slices_of(const RunConfig& config, const kernels::ProgramSpec& program, std::uint32_t asked);

/// As simulate(), with the frame's tiles cut into slices, each played on a machine of its own, as many at once as there
/// are threads (docs/slices.md). The result does not depend on these.
FrameResult simulate_slices(const Inputs& inputs, const kernels::ProgramSpec& program, std::uint32_t threads,
                            std::uint32_t slices, Progress* progress = nullptr);

/// Plays slice `index`, from 0, of so many alone. What it comes to, to be kept until all others are there.
sim::Json simulate_slice(const Inputs& inputs, const kernels::ProgramSpec& program, std::uint32_t threads,
                         std::uint32_t slices, std::uint32_t index);
/// The frame that all of its slices make, in order: as by simulate_slices(), without the picture. InputError for what
/// are no slices of the frame.
FrameResult join_slices(const Inputs& inputs, const kernels::ProgramSpec& program, std::span<const sim::Json> slices);

/// Marks a frame that was played whole as one that has one slice.
SlicedFrame uncut(const FrameResult& s);

}  // namespace tools
