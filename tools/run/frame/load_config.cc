#include "tools/run/frame/load_config.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <iterator>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "hw_models/build/tree_builder.h"
#include "hw_models/machines/gpu_config.h"
#include "hw_models/memory/unit_names.h"
#include "hw_models/raster/raster_unit.h"
#include "hw_models/tni/predictor_stage.h"
#include "sim/config/config.h"
#include "sim/config/quantity.h"
#include "sim/edit_distance.h"
#include "sim/error.h"
#include "sim/io/printable.h"
#include "sim/report/energy.h"
#include "tools/host/paths.h"
#include "tools/run/frame/machine_run.h"
#include "tools/run/frame/power.h"
#include "traces/scene/did_you_mean.h"
#include "traces/scenes/library.h"

namespace tools {
namespace {

/// Top-level keys that a workload file may have: they define the rendered work, not the machine.
constexpr std::array<std::string_view, 5> kWorkloadKeys = {"scene", "render", "bvh", "build", "denoise"};

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
  throw sim::InputError(fmt::format(
      "{}: has no energy figures; allowed: 'extends: sgrt-2016' as its first line, then what differs", origin));
}

/// Throws InputError, with the nearest name, for an unknown scene or workload. traces/ cannot check this, because it
/// does not know the workloads.
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

void load_base(sim::ConfigLoader& loader, RunConfig& config, const std::string& name, const std::string& scene,
               const std::vector<std::string>& sets) {
  sim::set_config_search_path(config_folders());
  loader.read_bundle_choices(sets);
  loader.apply_file(find_config(name));
  if (const std::optional<std::filesystem::path> workload = find_workload(scene)) {
    apply_workload(loader, config, *workload);
  }
}

/// Applies --set and other options to a configuration and checks the result. `origin`: name of the configuration in
/// errors.
void apply_options_and_check(sim::ConfigLoader& loader, const sim::ConfigNode& tree, RunConfig& config,
                             const JobOptions& options, const std::string& origin) {
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
  set_automatic_cache_hit_cycles(config);
  sim::check_tree(tree, origin);
  check_energy_figures(config, origin);
  check_power(config);
}

/// A group of keys that have no effect for some values of other keys.
struct IneffectiveKeys {
  std::string_view keys;
  bool (*is_ineffective)(const RunConfig& config);
  std::string_view why;
};

constexpr std::array kIneffectiveKeys = {
    IneffectiveKeys{"render.mip_filter", [](const RunConfig& c) { return c.render.mip_maps == traces::MipMaps::kOff; },
                    "with render.mip_maps=off"},
    IneffectiveKeys{"scene.view.", [](const RunConfig& c) { return c.scene.view.source == traces::ViewSource::kScene; },
                    "without scene.view.source=own"},
    IneffectiveKeys{"scene.sky.", [](const RunConfig& c) { return c.scene.sky.source == traces::Sky::kScene; },
                    "without scene.sky.source=own"},
    IneffectiveKeys{"scene.lights.position",
                    [](const RunConfig& c) { return c.scene.lights.rig != traces::LightRig::kPoint; },
                    "without scene.lights.rig=point"},
    IneffectiveKeys{"scene.lights.direction",
                    [](const RunConfig& c) { return c.scene.lights.rig != traces::LightRig::kSun; },
                    "without scene.lights.rig=sun"},
    IneffectiveKeys{"scene.lights.intensity",
                    [](const RunConfig& c) {
                      return c.scene.lights.rig != traces::LightRig::kPoint &&
                             c.scene.lights.rig != traces::LightRig::kSun;
                    },
                    "without scene.lights.rig=point or sun"},
    IneffectiveKeys{"build.period", [](const RunConfig& c) { return c.build.policy != traces::BuildPolicy::kPeriod; },
                    "without build.policy=period"},
    IneffectiveKeys{"build.cost_growth",
                    [](const RunConfig& c) { return c.build.policy != traces::BuildPolicy::kCost; },
                    "without build.policy=cost"},
    IneffectiveKeys{"build.overlap", [](const RunConfig& c) { return c.build.engine == traces::BuildEngine::kHost; },
                    "without build.engine=unit"},
    IneffectiveKeys{"tree_builder.", [](const RunConfig& c) { return c.build.engine != traces::BuildEngine::kUnit; },
                    "without build.engine=unit"},
    IneffectiveKeys{"tni.predictor.", [](const RunConfig& c) { return !c.gpu->tni.predictor.enabled; },
                    "without tni.predictor.enabled"},
    IneffectiveKeys{"slc.", [](const RunConfig& c) { return !c.gpu->slc.is_present(); }, "without slc.size"},
    IneffectiveKeys{"background.", [](const RunConfig& c) { return c.gpu->background.rate == 0; },
                    "without background.rate"},
    IneffectiveKeys{"dram.refreshed_part",
                    [](const RunConfig& c) { return c.gpu->dram.idle == hw::DramIdle::kPowerDown; },
                    "without dram.idle=self_refresh"},
    IneffectiveKeys{"scene.orbit", [](const RunConfig& c) { return c.scene.camera_path == traces::CameraPath::kScene; },
                    "without scene.camera_path=orbit"}};

/// True for a key that turns other keys on or off.
bool is_switch(std::string_view key) {
  return key.ends_with(".source") || key.ends_with(".enabled") || key == "slc.size" || key == "background.rate";
}

/// Warns if dram.grade is set to the name of a grade that has a configuration file.
void add_grade_warning(const std::string& set, std::vector<std::string>& out) {
  if (!set.starts_with("dram.grade=")) return;
  std::string grade = set.substr(set.find('=') + 1);
  std::ranges::transform(grade, grade.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  const std::vector<std::string> known = config_names_in("dram");
  const auto meant = sim::find_nearest("dram/" + grade, known, grade.size() / 4);
  if (meant == known.end()) return;
  out.push_back(fmt::format("dram.grade is only a name in reports; --set dram.extends={} sets the timing",
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
  field.bundle_choice(NAMED(c.process),
                      "process of the chip: selects the tables of energy, area, voltage and latency together",
                      {"energy", "area", "power", "latency"}, sim::Affects::kEnergy);
  hw::GpuConfig::describe(*c.gpu, field);
  field.group(NAMED(c.render), "what is rendered, and how finely");
  kernels::ProgramConfig::describe(c.programs, field);
  field.group(NAMED(c.bvh), "build of the tree on the host, and its layout in memory");
  field.group(NAMED(c.build), "building and refitting of trees as work of the machine");
  field.group(NAMED(c.energy), "energy per event, leakage and clock");
  field.group(NAMED(c.power), "voltage and temperature, and their effect on energy");
  field.group(NAMED(c.area), "area of storage and pads; that of logic is in energy.logic");
  field.group(NAMED(c.latency), "hit latency of caches over size, for hit_cycles auto");
  field.group(NAMED(c.thermal), "heat path of the device and its governor (raywatt sustain)");
  field.group(NAMED(c.frame), "a frame in a sequence: its start, its rate");
  field.group(NAMED(c.scene), "scene, camera and frames");
  field.group(NAMED(c.limits), "limits for scene files");
}

/// Complains about records of the tree builder that have no room for the keys of bvh.morton_bits.
void RunConfig::check_sorted_records(auto&& complain) const {
  constexpr std::uint32_t kLongKeyBits = 63, kShortRecord = 8, kShortRecordWithBox = 32;
  const std::uint32_t bytes = gpu->tree_builder.record_bytes;
  if (build.engine != traces::BuildEngine::kUnit || bvh.builder == traces::TreeBuilder::kEmbree) return;
  if (bvh.morton_bits < kLongKeyBits || (bytes != kShortRecord && bytes != kShortRecordWithBox)) return;
  complain("tree_builder.record_bytes", fmt::format("is {}, without room for keys of 63 bits; allowed with "
                                                    "bvh.morton_bits: 63: 12, or 36 with boxes",
                                                    bytes));
}

void RunConfig::check(auto&& complain) const {
  gpu->check(complain);
  if (gpu->tni.predictor.enabled && bvh.instances == traces::InstanceLevels::kTwoLevel) {
    complain("tni.predictor.enabled",
             "is true, and a predicted node has no instance; allowed with it: bvh.instances=flatten");
  }
  if (build.engine == traces::BuildEngine::kUnit && bvh.builder == traces::TreeBuilder::kPloc &&
      gpu->tree_builder.comparators == 0) {
    complain("build.engine",
             "is unit, which has no comparators for bvh.builder: ploc; allowed: tree_builder.comparators "
             "of 1 or more");
  }
  check_sorted_records(complain);
  if (build.engine != traces::BuildEngine::kSrp) return;
  if (bvh.builder == traces::TreeBuilder::kPloc) {
    complain("build.engine", "is srp, whose kernels sort Morton codes; allowed with bvh.builder: ploc: host, unit");
  }
  constexpr std::uint32_t kMostMortonBits = 30;  // of keys in one word
  if (bvh.morton_bits > kMostMortonBits) {
    complain("build.engine",
             "is srp, whose kernels sort keys of one word; allowed with it: bvh.morton_bits of 24 or 30");
  }
  const auto refuse_format = [&](const char* key) {
    complain(key,
             "is a format that the kernels of build.engine: srp do not write; allowed with it: build.engine of host "
             "or unit");
  };
  if (bvh.node_format() == traces::NodeFormat::kHybrid) {
    refuse_format(bvh.format == traces::NodeFormat::kHybrid ? "bvh.format" : "bvh.numbers");
  }
  if (bvh.boxes != traces::BoxRecords::kPair) refuse_format("bvh.boxes");
  if (bvh.leaf != traces::LeafFormat::kTriangles) refuse_format("bvh.leaf");
  if (bvh.triangle_bytes != sizeof(traces::TriangleRecord)) refuse_format("bvh.triangle_bytes");
}

RunConfig load_run_config(const JobOptions& options) {
  RunConfig config;
  sim::ConfigNode tree = sim::config_tree(config);
  sim::ConfigLoader loader(tree);
  load_base(loader, config, options.config, options.scene, options.sets);
  apply_options_and_check(loader, tree, config, options, find_config(options.config).string());
  return config;
}

RunConfig load_base_config(const std::string& name, const std::string& scene, const std::vector<std::string>& sets) {
  RunConfig config;
  sim::ConfigNode tree = sim::config_tree(config);
  sim::ConfigLoader loader(tree);
  load_base(loader, config, name, scene, sets);
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
  apply_options_and_check(loader, tree_, config_, options, origin_);
  return config_;
}

std::vector<std::string> ineffective_setting_warnings(const JobOptions& options, const RunConfig& config) {
  std::vector<std::string> out;
  for (const std::string& set : options.sets) {
    const std::string_view key = std::string_view(set).substr(0, set.find('='));
    for (const IneffectiveKeys& idle : kIneffectiveKeys) {
      if (!key.starts_with(idle.keys) || is_switch(key) || !idle.is_ineffective(config)) continue;
      std::string line = fmt::format("{} has no effect {}", key, idle.why);
      if (std::ranges::find(out, line) == out.end()) out.push_back(std::move(line));
    }
    add_grade_warning(set, out);
  }
  const bool is_on_grid = options.program.starts_with("multirate") || options.program == "undersample";
  // the only sample is at the pixel's centre with any pattern
  const bool has_one_sample = options.reference == "full:1";
  if (is_on_grid && !options.reference.empty() && !has_one_sample &&
      config.render.samples != kernels::SamplePattern::kRegular) {
    out.push_back(fmt::format("{} takes its samples in a regular grid, {} does not with this render.samples",
                              options.program, options.reference));
  }
  return out;
}

std::vector<std::string> tree_builder_warnings(const RunConfig& config) {
  if (config.build.engine == traces::BuildEngine::kHost || config.bvh.builder != traces::TreeBuilder::kEmbree) {
    return {};
  }
  return {
      fmt::format("build.engine={} charges sorting and merging, but rays find the better tree of bvh.builder=embree; "
                  "bvh.builder=lbvh builds what is charged",
                  names_of(config.build.engine)[static_cast<std::size_t>(config.build.engine)])};
}

void apply_ideal(RunConfig& config, const std::vector<std::string>& resources) {
  for (const hw::IdealConfig::Resource& resource : hw::IdealConfig::kResources) {
    if (std::ranges::find(resources, resource.name) != resources.end()) config.gpu->ideal.*resource.member = true;
  }
}

void check_run_config(RunConfig& config, const std::string& origin) {
  set_automatic_cache_hit_cycles(config);
  sim::check_tree(sim::config_tree(config), origin);
  check_energy_figures(config, origin);
  check_power(config);
}

namespace {

constexpr const char* kCurve = "read";
/// Tolerance for rounding: a latency that exceeds a whole number of cycles by less is not rounded up.
constexpr double kCycleRounding = 1e-9;

struct Cache {
  std::string path;
  hw::CacheConfig& cache;
  std::uint64_t hz;
  std::uint32_t around;  ///< cycles of a hit in addition to the time to read the cache's array
};

/// Returns the caches whose hit_cycles is `auto`.
std::vector<Cache> automatic_caches(RunConfig& config) {
  hw::GpuConfig& gpu = *config.gpu;
  std::vector<Cache> caches;
  const auto add = [&](const char* path, hw::CacheConfig& cache, std::uint64_t hz, std::uint32_t around) {
    if (cache.hit_cycles.is_auto) caches.push_back({path, cache, hz, around});
  };
  add("tni.trv.l1", gpu.tni.trv.l1, gpu.clocks.tni.hz, config.latency.l1);
  add("tni.ist.l1", gpu.tni.ist.l1, gpu.clocks.tni.hz, config.latency.l1);
  add("l2", gpu.l2.cache, gpu.clocks.l2.hz, config.latency.l2);
  if (gpu.slc.is_present()) add("slc", gpu.slc.cache, gpu.clocks.l2.hz, config.latency.l2);
  return caches;
}

const sim::EnergyCurve& curve_of(const sim::EnergyTable& table, const std::string& path) {
  if (!table.contains(kCurve) || !table.curve_of(kCurve).depends_on_size()) {
    throw sim::InputError(
        fmt::format("{}.hit_cycles: auto needs latency.arrays; allowed: a number, or points such as "
                    "read@16KiB, as in latency.extends=latency/22nm",
                    path));
  }
  return table.curve_of(kCurve);
}

/// Throws InputError for an entry of the latency table that no cache uses, because its name must be misspelt.
void check_names(const sim::EnergyTable& table) {
  for (const std::string& name : table.event_names()) {
    if (name == kCurve) continue;
    throw sim::InputError(
        fmt::format("latency.arrays.{}: no latency goes by this name; allowed: {}, with a size such as "
                    "{}@16KiB",
                    sim::printable(name), kCurve, kCurve));
  }
}

}  // namespace

void set_automatic_cache_hit_cycles(RunConfig& config) {
  constexpr double kHzPerNanosecond = 1e9;
  const sim::EnergyTable table(config.latency.arrays, "latency.arrays");
  check_names(table);
  for (const Cache& c : automatic_caches(config)) {
    const sim::EnergyCurve& curve = curve_of(table, c.path);
    if (c.cache.size.bytes == 0) continue;  // check_tree() reports this error
    const double ns = curve.point_at(c.cache.size.bytes).energy_of(&sim::Band::nominal);
    const double cycles = std::ceil(ns * static_cast<double>(c.hz) / kHzPerNanosecond - kCycleRounding);
    c.cache.hit_cycles.value = std::max(1U, c.around + static_cast<std::uint32_t>(cycles));
  }
}

bool uses_latency_table(const RunConfig& config) {
  RunConfig read = config;
  return !automatic_caches(read).empty();
}

std::vector<std::string> latency_warnings(const RunConfig& config) {
  std::vector<std::string> lines;
  RunConfig read = config;
  const sim::EnergyTable table(read.latency.arrays, "latency.arrays");
  for (const Cache& c : automatic_caches(read)) {
    const sim::EnergyCurve& curve = curve_of(table, c.path);
    const std::uint64_t bytes = c.cache.size.bytes;
    if (bytes >= curve.smallest_array_bytes() && bytes <= curve.largest_array_bytes()) continue;
    const auto size = [](std::uint64_t b) { return sim::quantity_text(b, sim::byte_units()); };
    lines.push_back(
        fmt::format("latency.arrays: {} has {}, outside {} to {} of {}, and its hit_cycles of {} are extrapolated",
                    c.path, size(bytes), size(curve.smallest_array_bytes()), size(curve.largest_array_bytes()), kCurve,
                    c.cache.hit_cycles.value));
  }
  return lines;
}

namespace {

/// Returns the report of an idle unit that a frame may not need, so that its table entries are valid for all frames.
template <class Unit>
sim::UnitReport absent_unit(const std::string& path, const std::vector<sim::UnitPart>& parts = {}) {
  sim::UnitReport unit;
  unit.path = path;
  unit.parts = parts;
  unit.block = names_of(hw::Block{})[static_cast<std::size_t>(Unit::kBlock)];
  const typename Unit::Stats none;
  Unit::Stats::describe(none, [&](const std::uint64_t& value, const char* name, const char* meaning,
                                  const char* event = "", sim::CounterKind kind = sim::CounterKind::kSum) {
    unit.counters.push_back({name, meaning, value, event, kind});
  });
  return unit;
}

}  // namespace

void check_table_names(std::span<const sim::UnitReport> units, const RunConfig& config) {
  std::vector<sim::UnitReport> all(units.begin(), units.end());
  all.push_back(absent_unit<hw::RasterUnit>(hw::unit_name_in_core(hw::RasterUnit::kName, 0)));
  all.push_back(absent_unit<hw::PredictorStage>(hw::unit_name_in_core(hw::PredictorStage::kName, 0)));
  all.push_back(absent_unit<hw::TreeBuilder>(hw::TreeBuilder::kName, config.gpu->tree_builder.parts()));
  std::vector<std::string> declared;
  for (const sim::UnitReport& unit : all) {
    for (const sim::CounterReport& counter : unit.counters) {
      if (unit.block != "dram" && !counter.event.empty()) declared.push_back(counter.event);
    }
  }
  sim::check_energy_events(config.energy, declared);
  sim::check_unit_names(config.energy, all);
  sim::check_unit_names(config.area, all);
}

namespace {

/// Returns the process node without blanks: "14nm" for "14 nm, 0.80 V, 75 C".
std::string process_node_name(std::string process) {
  std::erase(process, ' ');
  return process.substr(0, process.find(','));
}

}  // namespace

std::vector<std::string> process_warnings(const RunConfig& config) {
  std::vector<std::pair<const char*, std::string>> tables = {{"energy", config.energy.process}};
  if (!config.area.arrays.empty()) tables.emplace_back("area", config.area.process);
  if (!config.power.dvfs.empty()) tables.emplace_back("power", config.power.process);
  if (uses_latency_table(config)) tables.emplace_back("latency", config.latency.process);
  std::erase_if(tables, [](const auto& table) { return table.second == sim::EnergyConfig().process; });
  const auto differs = [&](const auto& table) {
    return process_node_name(table.second) != process_node_name(tables.front().second);
  };
  if (std::ranges::none_of(tables, differs)) return {};
  std::vector<std::string> texts;
  for (const auto& [name, process] : tables) {
    texts.push_back(fmt::format("{}.process is '{}'", name, sim::printable(process)));
  }
  return {fmt::format("process: {}: results mix processes; process={} sets all tables", fmt::join(texts, ", "),
                      sim::printable(process_node_name(tables.front().second)))};
}

std::vector<std::string> technology_table_warnings(const RunConfig& config, std::span<const sim::UnitReport> units) {
  std::vector<std::string> lines = sim::curve_range_warnings(units, config.energy.events, config.area.arrays);
  std::ranges::move(latency_warnings(config), std::back_inserter(lines));
  std::ranges::move(power_warnings(config), std::back_inserter(lines));
  std::ranges::move(process_warnings(config), std::back_inserter(lines));
  return lines;
}

std::vector<std::string> technology_table_warnings(const RunConfig& config) {
  return technology_table_warnings(config, idle_unit_reports(*config.gpu, optional_units_of(config), config.bvh));
}

void add_warnings(std::vector<std::string>& lines, const std::vector<std::string>& more) {
  for (const std::string& line : more) {
    if (std::ranges::find(lines, line) == lines.end()) lines.push_back(line);
  }
}

}  // namespace tools

template sim::ConfigNode sim::config_tree(tools::RunConfig& config);
