#include "tools/host/paths.h"

#include <algorithm>
#include <cstdlib>
#include <sstream>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "sim/error.h"
#include "sim/io/printable.h"
#include "tools/host/build_info.h"
#include "traces/scene/did_you_mean.h"

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

}  // namespace

std::vector<std::string> config_names() { return yaml_names(config_folders()); }

std::vector<std::string> workload_names() { return yaml_names(workload_folders()); }

std::optional<fs::path> find_workload(const std::string& argument) {
  if (argument.ends_with(".yaml")) return argument;
  if (argument.empty() || argument.find('/') != std::string::npos) return std::nullopt;
  return find_yaml(workload_folders(), argument);
}

fs::path find_config(const std::string& argument) {
  if (argument.find('/') != std::string::npos || argument.ends_with(".yaml")) return argument;
  if (const std::optional<fs::path> found = find_yaml(config_folders(), argument)) return *found;
  const std::vector<std::string> names = config_names();
  throw sim::InputError(fmt::format("no configuration is called '{}'{}; known: {}; or give a path to a .yaml file",
                                    sim::printable(argument), traces::did_you_mean(argument, names),
                                    fmt::join(names, ", ")));
}

}  // namespace tools
