#pragma once
#include <filesystem>

#include "tools/run/frame/job_options.h"

namespace tools {

// The work of `raywatt run`, `verify` and `trace`. Each writes its results and prints what they come to, unless it is
// to be quiet. sim::InputError, sim::IoError, sim::Deadlock, Interrupted.

/// Renders frames on the simulated GPU.
void run_frames(const JobOptions& options);
/// Plays the list of rays that the options name on T&I units, caches and memory (schema raywatt-rays/1). An interrupt
/// leaves the rays that are finished, unless there is a former run in their place.
void run_rays(const JobOptions& options);

/// Compares every ray of frames, or of the list, with Embree: kGood or kCheckFailed.
int verify_frames(const JobOptions& options);
int verify_rays(const JobOptions& options);

/// Writes the work of frames into a trace; no machine is simulated.
void record_trace(const JobOptions& options, const std::filesystem::path& file);
/// Plays a trace on a machine: the options' configuration, or if that is empty the one it was recorded with.
void replay_trace(const JobOptions& options, const std::filesystem::path& file);

}  // namespace tools
