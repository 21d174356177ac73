#pragma once
#include <string>

#include "sim/io/json.h"
#include "tools/run/frame/frame_rate.h"
#include "tools/run/frame/load_config.h"
#include "tools/run/frame/run_job.h"

namespace tools {

/// Adds at_fps, power_at_fps_w and fps_margin to the totals of a report, and their statistics if it has replicates. No
/// effect if frame.fps is 0. `frames`: the report's list of frames.
void add_frame_rate(sim::Json& totals, const FrameResult& run, const sim::Json& frames, const RunConfig& config);

/// Returns the totals at_fps, power_at_fps_w and fps_margin.
sim::Json frame_rate_json(const FrameRate& rate);

/// Formats at_fps for a table, in one line: "60 frames/s met, 3.1 ms to spare, 0.81 W".
std::string frame_rate_text(const sim::Json& totals);
/// Formats the operating points in one line; empty if there are none.
std::string operating_points_text(const sim::Json& totals);

}  // namespace tools
