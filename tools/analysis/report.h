#pragma once
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "sim/io/json.h"
#include "sim/report/area.h"
#include "sim/report/energy.h"
#include "sim/unit_report.h"
#include "tools/run/frame/load_config.h"
#include "tools/run/frame/run_job.h"

namespace tools {

/// One or all frames of a run, with the reference, if any.
struct ComparedResult {
  const FrameResult& run;
  const FrameResult* reference = nullptr;
  double squared_error = 0;  ///< mean over the channels of the pictures, with a reference
};

/// Returns a frame (`frames[]`) or all frames (`totals`) as in report.json.
sim::Json totals_json(const ComparedResult& result);

struct ReportInput {
  const Inputs& inputs;
  const JobOptions& options;
  const ComparedResult& result;
  const sim::Json& frames;  ///< one entry per frame
  bool partial = false;     ///< true if interrupted before the last frame
  double wall_seconds = 0;  ///< host time of the whole job
};

/// Returns report.json, schema raywatt-report/1. Everything except `host` and `provenance.argv` depends only on the
/// inputs.
sim::Json report_json(const ReportInput& report);

/// Returns the origin of the result: program, configuration, scene, command line.
sim::Json provenance_json(const Inputs& inputs, const JobOptions& options);

/// Formats a report as tables for a terminal.
std::string report_table(const sim::Json& report);

/// Returns the peak resident memory of this process in MiB.
double peak_rss_mib();

/// Returns totals.sampling of a report: traced and wanted samples, reasons for tracing, and the cost of the decision.
sim::Json sampling_json(const FrameResult& run);

/// Returns the share of similar samples among those checked and the block side, for each tile, by rows.
sim::Json tiles_json(const kernels::Sampling& sampling);

/// Amount of work that energy is divided by.
struct WorkDone {
  double time_ms = 0, rays = 0, frames = 0;
};

/// Returns the totals that follow from energy: energy_mj and its parts, power_w, and perf.nj_per_ray,
/// frames_per_joule_gpu and frames_per_joule_tni.
sim::Json energy_totals_json(const sim::EnergyReport& energy, const WorkDone& work);

/// Adds the machine's area by block and by part to the totals, and perf.frames_per_joule_per_mm2 and
/// perf.mrays_per_s_per_mm2. No effect without an area table.
void add_area(sim::Json& totals, std::span<const sim::UnitReport> units, const RunConfig& config);

/// Returns the warnings of report.json from the run itself: table_warnings(), and sampling that simulated more than
/// requested.
std::vector<std::string> run_warnings(const RunConfig& config, std::span<const sim::UnitReport> units,
                                      const std::optional<SampledFrame>& sampled = {});

}  // namespace tools
