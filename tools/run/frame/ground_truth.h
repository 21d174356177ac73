#pragma once
#include <cstdint>
#include <filesystem>
#include <vector>

#include "tools/run/frame/run_job.h"

namespace tools {

/// The picture that others are measured by: many jittered samples per pixel, traced by Embree, with another seed than
/// any frame program's. Linear RGB, row by row.
///
/// It is kept as EXR in `cache` under a name made from all it depends on: scene, camera, frame, the configuration's
/// groups `scene` and `render`, samples, model id. A digest beside it says that the file is what was written: anything
/// else is not used but written anew. What cannot be kept is rendered each time. `inputs` are as before when it
/// returns. Interrupted if an interrupt waits.
std::vector<float> ground_truth(Inputs& inputs, std::uint32_t samples, std::uint32_t threads,
                                const std::filesystem::path& cache, Progress* progress = nullptr);

/// $XDG_CACHE_HOME/raywatt, else ~/.cache/raywatt; empty if there is neither.
std::filesystem::path cache_folder();

}  // namespace tools
