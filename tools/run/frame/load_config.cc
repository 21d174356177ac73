#include "tools/run/frame/load_config.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <optional>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "hw_models/machines/gpu_config.h"
#include "sim/config/config.h"
#include "sim/edit_distance.h"
#include "sim/error.h"
#include "sim/io/printable.h"
#include "tools/host/paths.h"
#include "tools/run/frame/config_variants.h"
#include "tools/run/frame/power.h"
#include "traces/scene/did_you_mean.h"
#include "traces/scenes/library.h"

namespace tools {
namespace {

/// Keys of a workload file: the work, without the machine.
constexpr std::array<std::string_view, 3> kWorkloadKeys = {"scene", "render", "bvh"};

void apply_workload(sim::ConfigLoader& loader, RunConfig& config, const std::filesystem::path& file) {
  loader.apply_file_with_keys(file, kWorkloadKeys);
  const std::filesystem::path scene = config.scene.name;
  if (traces::is_scene_file(config.scene.name) && scene.is_relative()) {
    config.scene.name = (file.parent_path() / scene).lexically_normal().string();
  }
  try {
    if (traces::scene_file(config.scene.name).empty()) traces::check_builtin_name(config.scene.name);
  } catch (const sim::InputError& error) {
    sim::refuse(sim::printable(file.string()), "scene.name", error.what());
  }
}

void check_energy_figures(const RunConfig& config, const std::string& origin) {
  if (!config.energy.events.empty()) return;
  throw sim::InputError(
      fmt::format("{}: energy: no figures; a file that lists only what differs begins with a line "
                  "such as 'extends: sgrt-2016'",
                  origin));
}

/// Throws InputError with the nearest scene or workload; traces/ does not have the list of workloads.
void check_scene_name(const std::string& name) {
  if (traces::is_scene_file(name) || !traces::scene_file(name).empty()) return;
  std::vector<std::string> names = workload_names();
  for (const traces::BuiltinInfo& scene : traces::builtin_scenes()) {
    if (scene.name == name) return;
    names.push_back(scene.name);
  }
  const std::filesystem::path path(name);
  for (const char* extension : {".glb", ".gltf"}) {
    std::error_code failed;
    if (!std::filesystem::exists(name + extension, failed)) continue;
    throw sim::InputError(
        fmt::format("no scene is called '{0}'; allowed: --scene {0}{1}", sim::printable(name), extension));
  }
  if (path.has_extension()) {
    throw sim::InputError(
        fmt::format("'{}' is no glTF file; allowed: .glb, .gltf; convert it first, e.g. with npx obj2gltf or Blender",
                    sim::printable(name)));
  }
  throw sim::InputError(
      fmt::format("no scene is called '{}'{}; built in, and workloads: {}; a file is given with its extension (.glb, "
                  ".gltf)",
                  sim::printable(name), traces::did_you_mean(name, names), fmt::join(names, ", ")));
}

}  // namespace

void check_scene(const std::string& name) {
  if (!find_workload(name)) check_scene_name(name);
}

namespace {

void load_base(sim::ConfigLoader& loader, RunConfig& config, const std::string& name, const std::string& scene) {
  sim::set_config_search_path(config_folders());
  loader.apply_file(find_config(name));
  if (const std::optional<std::filesystem::path> workload = find_workload(scene)) {
    apply_workload(loader, config, *workload);
  }
}

/// Applies options and checks the result. `origin`: name of the configuration in errors.
void apply_rest(sim::ConfigLoader& loader, const sim::ConfigNode& tree, RunConfig& config, const JobOptions& options,
                const std::string& origin) {
  for (const std::string& argument : options.sets) loader.apply_set(argument);
  if (!options.scene.empty() && !find_workload(options.scene)) {
    check_scene_name(options.scene);
    config.scene.name = options.scene;
  }
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
  set_hit_cycles(config);
  sim::check_tree(tree, origin);
  check_energy_figures(config, origin);
  check_power(config);
}

/// Keys, by prefix, that have no effect for some values of other keys.
struct Idle {
  std::string_view keys;
  bool (*is_idle)(const RunConfig& config);
  std::string_view why;
};

constexpr std::array kIdle = {
    Idle{"render.mip_filter", [](const RunConfig& c) { return c.render.mip_maps == traces::MipMaps::kOff; },
         "with render.mip_maps=off"},
    Idle{"scene.view.", [](const RunConfig& c) { return c.scene.view.source == traces::ViewSource::kScene; },
         "without scene.view.source=own"},
    Idle{"scene.sky.", [](const RunConfig& c) { return c.scene.sky.source == traces::Sky::kScene; },
         "without scene.sky.source=own"},
    Idle{"scene.lights.position", [](const RunConfig& c) { return c.scene.lights.rig != traces::LightRig::kPoint; },
         "without scene.lights.rig=point"},
    Idle{"scene.lights.direction", [](const RunConfig& c) { return c.scene.lights.rig != traces::LightRig::kSun; },
         "without scene.lights.rig=sun"},
    Idle{"scene.lights.intensity",
         [](const RunConfig& c) {
           return c.scene.lights.rig != traces::LightRig::kPoint && c.scene.lights.rig != traces::LightRig::kSun;
         },
         "without scene.lights.rig=point or sun"},
    Idle{"scene.orbit", [](const RunConfig& c) { return c.scene.camera_path == traces::CameraPath::kScene; },
         "without scene.camera_path=orbit"}};

/// Warns if dram.grade is set to the name of a grade that has a configuration file.
void tell_grade(const std::string& set, std::vector<std::string>& out) {
  if (!set.starts_with("dram.grade=")) return;
  std::string grade = set.substr(set.find('=') + 1);
  std::ranges::transform(grade, grade.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  const std::vector<std::string> known = config_names_in("dram");
  const auto meant = sim::find_nearest("dram/" + grade, known, grade.size() / 4);
  if (meant == known.end()) return;
  out.push_back(fmt::format("dram.grade is a name for reports and takes no figures; --set dram.extends={} does",
                            meant->substr(std::string_view("dram/").size())));
}

}  // namespace

MachineConfig::MachineConfig() : config_(std::make_unique<hw::GpuConfig>()) {}
MachineConfig::MachineConfig(const MachineConfig& other) : config_(std::make_unique<hw::GpuConfig>(*other)) {}
MachineConfig& MachineConfig::operator=(const MachineConfig& other) {
  *config_ = *other;
  return *this;
}
MachineConfig::~MachineConfig() = default;

void RunConfig::describe(auto& c, auto&& field) {
  hw::GpuConfig::describe(*c.gpu, field);
  field.group(NAMED(c.render), "what is rendered, and how finely");
  kernels::ProgramConfig::describe(c.programs, field);
  field.group(NAMED(c.bvh), "how the tree is built on the host, and how it lies in memory");
  field.group(NAMED(c.energy), "energy per event, leakage and clock");
  field.group(NAMED(c.power), "voltage and temperature: what clocks need, and what they do to energy");
  field.group(NAMED(c.area), "area of storage and pads; that of logic is in energy.logic");
  field.group(NAMED(c.latency), "time of a cache's hit over its size, where hit_cycles is auto");
  field.group(NAMED(c.scene), "what is looked at, from where, and when");
  field.group(NAMED(c.limits), "what a scene file may cost at most");
}

void RunConfig::check(auto&& complain) const { gpu->check(complain); }

RunConfig load_run_config(const JobOptions& options) {
  RunConfig config;
  sim::ConfigNode tree = sim::config_tree(config);
  sim::ConfigLoader loader(tree);
  load_base(loader, config, options.config, options.scene);
  apply_rest(loader, tree, config, options, find_config(options.config).string());
  return config;
}

RunConfig load_base_config(const std::string& name, const std::string& scene) {
  RunConfig config;
  sim::ConfigNode tree = sim::config_tree(config);
  sim::ConfigLoader loader(tree);
  load_base(loader, config, name, scene);
  return config;
}

ConfigVariants::ConfigVariants(RunConfig base, std::string origin)
    : base_(std::move(base)),
      config_(base_),
      origin_(std::move(origin)),
      base_tree_(sim::config_tree(base_)),
      tree_(sim::config_tree(config_)),
      variant_(base_tree_, tree_) {}

const RunConfig& ConfigVariants::apply(const JobOptions& options) {
  variant_.reset();
  sim::ConfigLoader loader(tree_);
  apply_rest(loader, tree_, config_, options, origin_);
  return config_;
}

std::vector<std::string> idle_settings(const JobOptions& options, const RunConfig& config) {
  std::vector<std::string> out;
  for (const std::string& set : options.sets) {
    const std::string_view key = std::string_view(set).substr(0, set.find('='));
    for (const Idle& idle : kIdle) {
      if (!key.starts_with(idle.keys) || key.ends_with(".source") || !idle.is_idle(config)) continue;
      std::string line = fmt::format("{} does nothing {}", key, idle.why);
      if (std::ranges::find(out, line) == out.end()) out.push_back(std::move(line));
    }
    tell_grade(set, out);
  }
  const bool is_on_grid = options.program.starts_with("multirate") || options.program == "undersample";
  const bool has_one_sample = options.reference == "full:1";  // at the pixel's centre with any pattern
  if (is_on_grid && !options.reference.empty() && !has_one_sample &&
      config.render.samples != kernels::SamplePattern::kRegular) {
    out.push_back(fmt::format("{} takes its samples in a regular grid, {} does not with this render.samples",
                              options.program, options.reference));
  }
  return out;
}

void apply_ideal(RunConfig& config, const std::vector<std::string>& resources) {
  for (const hw::IdealConfig::Resource& resource : hw::IdealConfig::kResources) {
    if (std::ranges::find(resources, resource.name) != resources.end()) config.gpu->ideal.*resource.member = true;
  }
}

void check_run_config(RunConfig& config, const std::string& origin) {
  set_hit_cycles(config);
  sim::check_tree(sim::config_tree(config), origin);
  check_energy_figures(config, origin);
  check_power(config);
}

}  // namespace tools

template sim::ConfigNode sim::config_tree(tools::RunConfig& config);
