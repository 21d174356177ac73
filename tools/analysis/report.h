#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "sim/io/json.h"
#include "sim/report/energy.h"
#include "sim/unit_report.h"
#include "tools/analysis/picture.h"
#include "tools/analysis/report_file.h"
#include "tools/noise/noise.h"
#include "tools/run/frame/load_config.h"
#include "tools/run/frame/run_job.h"

namespace tools {

struct TargetRate;

/// Result of one frame, or of all frames of a run, and the result of the reference program, if any.
struct ComparedResult {
  const FrameResult& run;
  const FrameResult* reference = nullptr;
  PictureError error = {};  ///< error of a frame's picture; for several frames: mean error, and largest error of a
                            ///< change
  std::optional<double> worst_squared_error = {};  ///< error of the worst picture of several frames
  const TargetRate* rate = nullptr;                ///< target frame rate of all frames; null: none
};

/// Returns the JSON of one frame (an entry of `frames`) or of all frames (`totals`) of report.json.
sim::Json totals_json(const ComparedResult& result);

struct ReportInput {
  const Inputs& inputs;
  const JobOptions& options;
  const ComparedResult& result;
  const sim::Json& frames;  ///< report of each frame
  bool partial = false;     ///< true if the run was interrupted before the last frame
  double wall_seconds = 0;  ///< host time of the whole job
};

/// Returns report.json, schema raywatt-report/1. Only `host` and `provenance.argv` depend on more than the inputs.
sim::Json report_json(const ReportInput& report);

/// Returns the origin of the result: program, configuration, scene, command line.
sim::Json provenance_json(const Inputs& inputs, const JobOptions& options);

/// Formats a report as tables for a terminal.
std::string report_table(const sim::Json& report);

/// Returns the peak resident memory of this process in MiB.
double peak_rss_mib();

/// Returns for each tile, row by row, the share of its checked samples that were similar, and the side of its blocks in
/// samples.
sim::Json tiles_json(const kernels::Sampling& sampling);

/// Time, rays and frames of a run, by which efficiency metrics divide its energy.
struct WorkDone {
  double time_ms = 0, rays = 0, frames = 0;
};

/// Returns the members of `totals` that are computed from energy: energy_mj and its parts, power_w, perf.nj_per_ray,
/// perf.frames_per_joule_gpu and perf.frames_per_joule_tni.
sim::Json energy_totals_json(const sim::EnergyReport& energy, const WorkDone& work);

/// Returns the warnings of a finished run for report.json: those of technology_table_warnings(), and one if tile
/// sampling simulated far more tiles than requested.
std::vector<std::string> run_warnings(const RunConfig& config, std::span<const sim::UnitReport> units,
                                      const std::optional<SampledFrame>& sampled = {});

/// Purposes of kernels; papers report the time of each separately. Checks include the compaction of results into
/// streams.
enum class KernelGroup : std::uint8_t { kTracing, kCheck, kInterpolation, kCorrection };

/// Returns the share of the shader cores' busy cycles spent in kernels of a group; nullopt if they were never busy.
std::optional<double> kernel_busy_share(const FrameResult& run, KernelGroup group);

/// Returns the share of time in which a core's T&I unit has no rays while its shader core runs checks or interpolation.
std::optional<double> starved_share(const FrameResult& run);

/// Returns mean, deviation and 95 % interval of a metric from its values in all replicates of a run.
sim::Json statistics_json(const std::vector<double>& values);
/// Formats the statistics of replicates as one line; replicates_table() formats the main metrics as a table.
std::string replicates_text(const sim::Json& replicates);
std::string replicates_table(const sim::Json& replicates);

/// Difference of a metric between two reports, with its noise.
struct NoisyDifference {
  double relative = 0;    ///< (b - a) / a of the two values, or of the means over replicates
  double half_width = 0;  ///< half-width of the 95 % interval of `relative`
  bool measured = false;  ///< true if both reports have replicates
  bool outside = false;   ///< true if the difference is larger than noise explains
};
/// Returns the difference of a metric between two reports; nullopt for metrics that have no noise or are 0.
std::optional<NoisyDifference> noisy_difference(const ReportFile& a, const ReportFile& b, const std::string& metric);

}  // namespace tools
