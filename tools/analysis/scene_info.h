#pragma once
#include <cstdint>
#include <string>

#include "sim/io/json.h"
#include "traces/accel/memory_image.h"
#include "traces/scene/scene.h"

namespace tools {

/// Cost of loading a scene and building its tree on this host.
struct SceneCost {
  double load_s = 0, build_s = 0;
  std::uint64_t file_bytes = 0;  ///< 0 for a built-in scene
  std::uint64_t peak_bytes = 0;  ///< most memory in use at a time, beyond what the program took before
};

/// Description of a scene: schema raywatt-scene/1. All but `host` follows from the scene alone.
sim::Json scene_info_json(const traces::Scene& scene, const traces::MemoryImage& image, const SceneCost& cost);

/// The same for people; `cameras`: also where each camera stands.
std::string scene_info_text(const sim::Json& info, bool cameras);

}  // namespace tools
