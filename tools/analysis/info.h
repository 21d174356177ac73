#pragma once
#include <cstdint>
#include <string>

#include "sim/io/json.h"
#include "traces/accel/memory_image.h"
#include "traces/scene/scene.h"
#include "traces/trace_file/trace_reader.h"

namespace tools {

/// Host time and memory to load a scene and build its BVH.
struct SceneCost {
  double load_s = 0, build_s = 0;
  std::uint64_t file_bytes = 0;  ///< size of the scene's file; 0 for a built-in scene
  std::uint64_t peak_bytes = 0;  ///< peak memory of the process above the level before loading
};

/// Returns a scene's description as JSON, schema raywatt-scene/1. All members except `host` depend only on the scene
/// and the BVH's configuration.
sim::Json scene_info_json(const traces::Scene& scene, const traces::MemoryImage& image, const traces::BvhConfig& config,
                          const SceneCost& cost);

/// Formats the description of a scene; `cameras`: also print the position of each camera.
std::string scene_info_text(const sim::Json& info, bool cameras);

/// Returns a summary of a trace file as JSON, schema raywatt-trace-info/1. Throws InputError if the trace is damaged.
sim::Json trace_info(const traces::TraceReader& trace);
/// Formats the result of trace_info() for a terminal, without configuration keys.
std::string trace_info_text(const sim::Json& info);

}  // namespace tools
