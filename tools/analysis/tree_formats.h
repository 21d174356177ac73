#pragma once
#include <string>

#include "sim/io/json.h"
#include "traces/accel/bvh_config.h"
#include "traces/scene/scene.h"

namespace tools {

/// Returns size, shape and SAH cost of a scene's tree for each width and node format, as a JSON array. Other keys are
/// those of `config`; a format that cannot store its leaves has smaller ones.
sim::Json tree_formats_json(const traces::Scene& scene, const traces::BvhConfig& config);

/// Formats the result of tree_formats_json() as a table with a row per format.
std::string tree_formats_text(const sim::Json& formats);

}  // namespace tools
