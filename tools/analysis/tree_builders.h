#pragma once
#include <string>

#include "sim/io/json.h"
#include "traces/accel/bvh_config.h"
#include "traces/accel/memory_image.h"
#include "traces/scene/scene.h"

namespace tools {

/// Returns a JSON array with a row per value of bvh.builder: size and SAH cost of the tree, rounds of ploc, and visits
/// and triangle tests per ray. Rays are 128 x 64 rays of the first camera, and a diffuse ray from each of their hits.
/// `image` is the scene's image with `config`.
sim::Json tree_builders_json(const traces::Scene& scene, const traces::MemoryImage& image,
                             const traces::BvhConfig& config);

/// Formats these rows as a table.
std::string tree_builders_text(const sim::Json& builders);

}  // namespace tools
