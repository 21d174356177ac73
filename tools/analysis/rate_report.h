#pragma once
#include <optional>
#include <string>

#include "sim/io/json.h"
#include "tools/run/frame/frame_rate.h"
#include "tools/run/frame/load_config.h"
#include "tools/run/frame/run_job.h"

namespace tools {

/// The target rate frame.fps of a run, and the time of its slowest frame over the mean frame time.
struct TargetRate {
  const RunConfig& config;
  double slowest_share = 1;
};

/// Returns the target rate of a run; nothing if frame.fps is 0. `frames`: the report's list of frames.
std::optional<TargetRate> target_rate(const FrameResult& run, const sim::Json& frames, const RunConfig& config);

/// Returns the members at_fps, power_at_fps_w and fps_margin of the totals of a run or of one of its replicates.
sim::Json frame_rate_json(const FrameResult& run, const TargetRate& target);
/// Returns the members at_fps, power_at_fps_w and fps_margin of a report's totals.
sim::Json frame_rate_json(const FrameRate& rate);

/// Returns one line on the target frame rate: "60 frames/s met, 3.1 ms to spare, 0.81 W; between frames 95 mW".
std::string frame_rate_text(const sim::Json& totals);
/// Returns one line on the clocks that meet the target rate: the slowest, and those with the least power; may be empty.
std::string operating_points_text(const sim::Json& totals);

}  // namespace tools
