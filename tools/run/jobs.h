#pragma once
#include <filesystem>

#include "tools/run/frame/job_options.h"

namespace tools {

// Implementations of `raywatt run`, `verify` and `trace`. Each writes its results and prints a summary unless quiet.
// sim::InputError, sim::IoError, sim::Deadlock, Interrupted.

/// Renders and simulates frames.
void run_frames(const JobOptions& options);
/// Simulates a list of rays on T&I units, caches and memory (schema raywatt-rays/1). An interrupt keeps the finished
/// rays, unless the folder has an earlier result.
void run_rays(const JobOptions& options);

/// Compares every ray of the frames, or of the list, with Embree. Returns kGood or kCheckFailed.
int verify_frames(const JobOptions& options);
int verify_rays(const JobOptions& options);

/// Writes the work of frames to a trace, without simulating a machine.
void record_trace(const JobOptions& options, const std::filesystem::path& file);
/// Simulates a trace on the machine of the options, or on the recorded one if they have no configuration.
void replay_trace(const JobOptions& options, const std::filesystem::path& file);

}  // namespace tools
