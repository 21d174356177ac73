#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "tools/run/frame/job_options.h"
#include "traces/ray.h"

namespace tools {

// Implementations of `raywatt run`, `verify` and `trace`. Each writes its results and prints a summary unless quiet.
// Throws sim::InputError, sim::IoError, sim::Deadlock, Interrupted.

/// Renders and simulates the frames of a scene (`raywatt run`).
void run_frames(const JobOptions& options);
/// Simulates a list of rays on T&I units, caches and memory (schema raywatt-rays/1). An interrupt keeps the finished
/// rays, unless the folder has an earlier result.
void run_rays(const JobOptions& options);

/// Compares every ray of the rendered frames, or of a ray file, with Embree. Returns kGood or kCheckFailed.
int verify_frames(const JobOptions& options);
int verify_rays(const JobOptions& options);

/// Writes the work of frames to a trace, without simulating a machine.
void record_trace(const JobOptions& options, const std::filesystem::path& file);
/// Simulates a trace on the machine in the options, or on the recorded machine if they name no configuration.
void replay_trace(const JobOptions& options, const std::filesystem::path& file);

/// The rays of a ray file (--rays).
struct RayList {
  std::vector<traces::Ray> rays;
  std::string sha256;  ///< SHA-256 of the file
};

/// Reads a file with 8 little-endian floats per ray: origin, t_min, direction, t_max. All are finite except t_max; 0 <=
/// t_min <= t_max; the direction is not zero. Throws InputError with the file and the ray's index, from 0.
RayList read_ray_list(const std::filesystem::path& path);

}  // namespace tools
