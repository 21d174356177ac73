#pragma once
#include <string>

#include "sim/io/json.h"
#include "tools/run/frame/run_job.h"

namespace tools {

/// One or all frames of a run, with the reference, if any.
struct Result {
  const FrameResult& run;
  const FrameResult* reference = nullptr;
  double squared_error = 0;  ///< mean over the channels of the pictures, with a reference
};

/// Returns a frame (`frames[]`) or all frames (`totals`) as in report.json.
sim::Json totals_json(const Result& result);

struct Report {
  const Inputs& inputs;
  const JobOptions& options;
  const Result& totals;
  const sim::Json& frames;  ///< one entry per frame
  bool partial = false;     ///< true if interrupted before the last frame
  double wall_seconds = 0;  ///< host time of the whole job
};

/// Returns report.json, schema raywatt-report/1. Everything except `host` and `provenance.argv` depends only on the
/// inputs.
sim::Json report_json(const Report& report);

/// Returns the origin of the result: program, configuration, scene, command line.
sim::Json provenance_json(const Inputs& inputs, const JobOptions& options);

/// Formats a report as tables for a terminal.
std::string report_table(const sim::Json& report);

/// Returns the peak resident memory of this process in MiB.
double peak_rss_mib();

/// Returns totals.sampling of a report: traced and wanted samples, reasons for tracing, and the cost of the decision.
sim::Json sampling_json(const FrameResult& simulation);

/// Returns the share of similar samples among those checked and the block side, for each tile, by rows.
sim::Json tiles_json(const kernels::Sampling& sampling);

}  // namespace tools
