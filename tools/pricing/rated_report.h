#pragma once
#include "tools/analysis/report_file.h"
#include "tools/run/frame/frame_rate.h"

namespace tools {

/// Evaluates the frames of a finished run at the target rate `fps`, with the run's own energy table. Throws InputError
/// if PricedRun cannot compute the energy of the run.
FrameRate evaluate_report_rate(const ReportFile& report, double fps);

/// Sets at_fps, power_at_fps_w and fps_margin in a report's totals to the values of a run with frame.fps = `fps`.
/// Removes their statistics over replicates, and metrics of a sustained run at another rate. Throws InputError like
/// evaluate_report_rate().
void set_frame_rate(ReportFile& report, double fps);

}  // namespace tools
