#include "tools/load_config.h"

#include <algorithm>
#include <array>
#include <optional>

#include <fmt/format.h>

#include "sim/config/config.h"
#include "sim/error.h"
#include "tools/paths.h"
#include "traces/scene/library.h"

namespace tools {

namespace {

/// What a workload file may say: all that describes the work, nothing of the machine.
constexpr std::array<std::string_view, 3> kWorkloadKeys = {"scene", "render", "bvh"};

void apply_workload(sim::ConfigLoader& loader, RunConfig& config, const std::filesystem::path& file) {
  loader.apply_part(file, kWorkloadKeys);
  const std::filesystem::path scene = config.scene.name;
  if (traces::is_scene_file(config.scene.name) && scene.is_relative()) {
    config.scene.name = (file.parent_path() / scene).lexically_normal().string();
  }
}

void check_energy_figures(const RunConfig& config, const std::string& origin) {
  if (!config.energy.events.empty()) return;
  throw sim::InputError(
      fmt::format("{}: energy: no figures; a file that lists only what differs begins with a line "
                  "such as 'extends: sgrt-2016'",
                  origin));
}

}  // namespace

RunConfig load_run_config(const JobOptions& options) {
  sim::set_config_search_path(config_folders());
  const std::filesystem::path file = find_config(options.config);
  RunConfig config;
  sim::ConfigNode tree = sim::config_tree(config);
  sim::ConfigLoader loader(tree);
  loader.apply_file(file);
  const std::optional<std::filesystem::path> workload = find_workload(options.scene);
  if (workload) apply_workload(loader, config, *workload);
  for (const std::string& argument : options.sets) loader.apply_set(argument);
  if (!workload && !options.scene.empty()) config.scene.name = options.scene;
  if (!options.camera.empty()) config.scene.camera = options.camera;
  if (!options.frames.empty()) {
    const FrameRange range = parse_frames(options.frames);
    config.scene.first_frame = range.first;
    config.scene.last_frame = range.last;
  }
  apply_ideal(config, options.ideal);
  if (!options.resolution.empty()) {
    const Resolution r = parse_resolution(options.resolution);
    config.render.width = r.width;
    config.render.height = r.height;
  }
  sim::check_tree(tree, file.string());
  check_energy_figures(config, file.string());
  return config;
}

void apply_ideal(RunConfig& config, const std::vector<std::string>& resources) {
  for (const hw::IdealConfig::Resource& resource : hw::IdealConfig::kResources) {
    if (std::ranges::find(resources, resource.name) != resources.end()) config.gpu.ideal.*resource.member = true;
  }
}

void check_run_config(RunConfig& config, const std::string& origin) {
  sim::check_tree(sim::config_tree(config), origin);
  check_energy_figures(config, origin);
}

}  // namespace tools
