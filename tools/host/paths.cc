#include "tools/host/paths.h"

#include <algorithm>
#include <cstdlib>
#include <sstream>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "sim/edit_distance.h"
#include "sim/error.h"
#include "sim/io/printable.h"
#include "tools/host/build_info.h"
#include "traces/scene/did_you_mean.h"
#include "traces/scenes/builtin.h"

namespace tools {

namespace fs = std::filesystem;

std::vector<fs::path> search_folders() {
  std::vector<fs::path> folders;
  if (const char* path = std::getenv("RAYWATT_PATH")) {
    std::istringstream parts(path);
    for (std::string part; std::getline(parts, part, ':');) {
      if (!part.empty()) folders.emplace_back(part);
    }
  }
  std::error_code ignored;
  const fs::path program = fs::read_symlink("/proc/self/exe", ignored);
  folders.push_back(program.parent_path().parent_path() / "share" / "raywatt");
  const bool is_where_built = program.string().starts_with(fmt::format("{}/", build_info().binary_dir));
  if (is_where_built) folders.emplace_back(build_info().source_dir);
  return folders;
}

std::vector<fs::path> config_folders() {
  std::vector<fs::path> folders;
  for (const fs::path& folder : search_folders()) folders.insert(folders.end(), {folder, folder / "configs"});
  return folders;
}

namespace {

std::vector<std::string> yaml_names(const std::vector<fs::path>& folders) {
  std::vector<std::string> names;
  for (const fs::path& folder : folders) {
    std::error_code missing;
    for (const auto& entry : fs::directory_iterator(folder, missing)) {
      if (entry.path().extension() == ".yaml") names.push_back(entry.path().stem());
    }
  }
  std::ranges::sort(names);
  names.erase(std::unique(names.begin(), names.end()), names.end());
  return names;
}

/// Returns "known: a, b" for an error message, or the searched folders if there are no configurations at all.
std::string known_text(const std::vector<std::string>& names) {
  if (!names.empty()) return fmt::format("known: {}", fmt::join(names, ", "));
  std::vector<std::string> folders;
  for (const fs::path& folder : search_folders()) folders.push_back(sim::printable(folder.string()));
  return fmt::format("none is known, there are no configurations in {} (which RAYWATT_PATH may name)",
                     fmt::join(folders, ", "));
}

std::vector<fs::path> workload_folders() {
  std::vector<fs::path> folders;
  for (const fs::path& folder : search_folders()) {
    folders.insert(folders.end(), {folder / "traces" / "workloads", folder / "workloads"});
  }
  return folders;
}

std::optional<fs::path> find_yaml(const std::vector<fs::path>& folders, const std::string& name) {
  for (const fs::path& folder : folders) {
    std::error_code too_long;
    const fs::path candidate = folder / (name + ".yaml");
    if (fs::exists(candidate, too_long)) return candidate;
  }
  return std::nullopt;
}

/// Throws InputError if a scene is given in place of a configuration.
void check_no_scene(const std::string& argument) {
  const bool is_bare = argument.find('/') == std::string::npos && !argument.ends_with(".yaml");
  if (is_bare && find_yaml(config_folders(), argument)) return;
  const bool is_file = argument.ends_with(".gltf") || argument.ends_with(".glb");
  const bool is_workload = is_bare && find_yaml(workload_folders(), argument);
  const auto builtin = traces::builtin_scenes();
  const bool is_builtin = std::ranges::find(builtin, argument, &traces::BuiltinInfo::name) != builtin.end();
  if (!is_file && !is_workload && !is_builtin) return;
  throw sim::InputError(fmt::format("'{0}' is a {1}, not a configuration; allowed: --scene {0}",
                                    sim::printable(argument), is_workload ? "workload" : "scene"));
}

/// Returns ", did you mean 'sgrt-2016'?" for an unknown configuration; suggests a scene if its name is nearer.
std::string suggest_name(const std::string& argument, const std::vector<std::string>& configs) {
  std::vector<std::string> scenes = workload_names();
  for (const traces::BuiltinInfo& scene : traces::builtin_scenes()) scenes.push_back(scene.name);
  const std::string_view start = sim::comparison_prefix(argument);
  const auto config = sim::find_nearest(start, configs, start.size() / 2);
  const std::size_t most = config == configs.end() ? start.size() / 2 : sim::edit_distance(start, *config);
  const auto scene = most == 0 ? scenes.end() : sim::find_nearest(start, scenes, most - 1);
  return scene == scenes.end() ? traces::did_you_mean(argument, configs)
                               : fmt::format(", did you mean --scene {}?", *scene);
}

}  // namespace

std::vector<std::string> config_names() { return yaml_names(config_folders()); }

std::vector<std::string> workload_names() { return yaml_names(workload_folders()); }

std::optional<fs::path> find_workload(const std::string& argument) {
  if (argument.ends_with(".yaml")) return argument;
  if (argument.empty() || argument.find('/') != std::string::npos) return std::nullopt;
  return find_yaml(workload_folders(), argument);
}

std::vector<std::string> config_names_in(const std::string& folder) {
  std::vector<fs::path> folders = config_folders();
  for (fs::path& each : folders) each /= folder;
  std::vector<std::string> names = yaml_names(folders);
  for (std::string& name : names) name.insert(0, folder + "/");
  return names;
}

fs::path find_config_file(const std::string& name) { return find_yaml(config_folders(), name).value(); }

fs::path find_experiment(const fs::path& argument, const std::string& folder) {
  const std::string name = argument.string();
  std::error_code too_long;
  if (name.find('/') != std::string::npos || name.ends_with(".yaml") || fs::exists(argument, too_long)) return argument;
  if (const std::optional<fs::path> found = find_yaml(config_folders(), folder + "/" + name)) return *found;
  std::vector<std::string> names = config_names_in(folder);
  for (std::string& each : names) each.erase(0, folder.size() + 1);
  throw sim::InputError(fmt::format("no experiment is called '{}'{}; {}; or give a path to a .yaml file",
                                    sim::printable(name), traces::did_you_mean(name, names), known_text(names)));
}

fs::path find_config(const std::string& argument) {
  check_no_scene(argument);
  if (argument.find('/') != std::string::npos || argument.ends_with(".yaml")) return argument;
  if (const std::optional<fs::path> found = find_yaml(config_folders(), argument)) return *found;
  if (argument.find('=') != std::string::npos) {
    throw sim::InputError(
        fmt::format("'{0}' is a setting, not a configuration; allowed: --set {0}", sim::printable(argument)));
  }
  const std::vector<std::string> names = config_names();
  throw sim::InputError(fmt::format("no configuration is called '{}'{}; {}; or give a path to a .yaml file",
                                    sim::printable(argument), suggest_name(argument, names), known_text(names)));
}

}  // namespace tools
