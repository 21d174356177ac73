#include "traces/scenes/library.h"

#include <algorithm>
#include <cctype>
#include <cstdlib>
#include <filesystem>
#include <optional>
#include <sstream>

#include "sim/error.h"
#include "sim/io/printable.h"
#include "traces/scene/gltf.h"

namespace traces {
namespace {

std::optional<std::filesystem::path> find_in_path(const std::string& name) {
  const char* variable = std::getenv("RAYWATT_PATH");
  std::istringstream folders(variable == nullptr ? "" : variable);
  for (std::string folder; std::getline(folders, folder, ':');) {
    if (folder.empty()) continue;
    for (const char* below : {"", "scenes"}) {
      for (const char* extension : {".glb", ".gltf"}) {
        std::filesystem::path path = std::filesystem::path(folder) / below / (name + extension);
        std::error_code ignored;
        if (std::filesystem::exists(path, ignored)) return path;
      }
    }
  }
  return std::nullopt;
}

}  // namespace

bool is_scene_file(const std::string& text) {
  if (text.find('/') != std::string::npos) return true;
  std::string extension = std::filesystem::path(text).extension().string();
  std::ranges::transform(extension, extension.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return extension == ".glb" || extension == ".gltf";
}

std::filesystem::path scene_file(const std::string& name_or_path) {
  if (is_scene_file(name_or_path)) return name_or_path;
  const std::vector<BuiltinInfo> builtin = builtin_scenes();
  if (std::ranges::any_of(builtin, [&](const BuiltinInfo& b) { return b.name == name_or_path; })) return {};
  return find_in_path(name_or_path).value_or(std::filesystem::path());
}

Scene open_scene(const std::string& name_or_path, const BuiltinOptions& options, const SceneLimits& limits) {
  const std::filesystem::path file = scene_file(name_or_path);
  if (file.empty()) return build_scene(name_or_path, options);
  if (options.triangles != 0) {
    throw sim::InputError(sim::printable(file.string()) + ": scene.triangles scales built-in scenes only; allowed: 0");
  }
  return load_gltf(file, limits);
}

}  // namespace traces
