#pragma once
#include <vector>

#include "tools/sampling/slice_play.h"

namespace tools {

/// The frame that all of its slices make: their times and counters added up, and how far they disagree about tiles at
/// borders (docs/slices.md). `function` is the whole frame's.
FrameResult add_up(const SlicePlayer& player, const kernels::ProgramSpec& program, FrontEnd::Result function,
                   std::vector<PlayedSlice> played);

}  // namespace tools
