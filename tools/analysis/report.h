#pragma once
#include <string>

#include "sim/io/json.h"
#include "tools/run/frame/run_job.h"

namespace tools {

/// A run, and the run it is compared with if there is one: of one frame, or of all.
struct Result {
  const FrameResult& run;
  const FrameResult* reference = nullptr;
  double squared_error = 0;  ///< mean over the pictures' channels, with a reference
};

/// A frame (`frames[]`) or all of them (`totals`) in report.json.
sim::Json totals_json(const Result& result);

struct Report {
  const Inputs& inputs;
  const JobOptions& options;
  const Result& totals;
  const sim::Json& frames;  ///< one entry per frame
  bool partial = false;     ///< interrupted before the last frame
  double wall_seconds = 0;  ///< time of the whole job
};

/// report.json, schema raywatt-report/1: everything but `host` and `provenance.argv` depends on the inputs alone.
sim::Json report_json(const Report& report);

/// Origin of the result: program, configuration, scene, command line.
sim::Json provenance_json(const Inputs& inputs, const JobOptions& options);

/// The table for a terminal, from the JSON.
std::string report_table(const sim::Json& report);

/// Peak resident memory of this process, in MiB.
double peak_rss_mib();

/// Samples that a frame program traced of those wanted, why, and the cost of deciding: totals.sampling of a report.
sim::Json sampling_json(const FrameResult& simulation);

/// The share of similar samples among those checked, and the blocks' side, of each tile, row by row.
sim::Json tiles_json(const kernels::Sampling& sampling);

}  // namespace tools
