#pragma once
#include "tools/analysis/report_file.h"
#include "tools/run/frame/frame_rate.h"

namespace tools {

/// Returns the frames of a finished run at a frame rate, by the run's own energy table. InputError if the report cannot
/// be priced (PricedRun).
FrameRate rate_of_report(const ReportFile& report, double fps);

/// Sets at_fps, power_at_fps_w and fps_margin in the totals of a report as a run with this frame.fps has them, without
/// statistics of replicates. InputError as rate_of_report().
void set_frame_rate(ReportFile& report, double fps);

}  // namespace tools
