#pragma once
#include <cstdint>
#include <filesystem>
#include <vector>

#include "tools/run/frame/run_job.h"

namespace tools {

/// Returns the ground truth picture: many jittered samples per pixel, traced by Embree, with a seed that no frame
/// program uses. Linear RGB by rows.
///
/// The picture is cached as EXR in `cache`. Its file name is a hash of scene, camera, frame, the groups `scene` and
/// `render`, samples and model id. A digest file validates it; a picture without a valid digest is rendered again.
/// `inputs` are unchanged on return. Throws Interrupted if an interrupt is pending.
std::vector<float> ground_truth(Inputs& inputs, std::uint32_t samples, std::uint32_t threads,
                                const std::filesystem::path& cache, Progress* progress = nullptr);

/// Returns $XDG_CACHE_HOME/raywatt, else ~/.cache/raywatt, else an empty path.
std::filesystem::path cache_folder();

}  // namespace tools
