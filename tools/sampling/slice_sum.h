#pragma once
#include <vector>

#include "tools/sampling/slice_play.h"

namespace tools {

/// Joins all slices to a frame: sums of times and counters, and an interval from the differences at borders
/// (docs/slices.md). `function`: results of rendering the frame.
FrameResult add_up(const SlicePlayer& player, const kernels::ProgramSpec& program, FrontEnd::Result function,
                   std::vector<PlayedSlice> played);

}  // namespace tools
