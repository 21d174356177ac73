#include <algorithm>
#include <filesystem>
#include <fstream>
#include <memory>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include "sim/error.h"
#include "sim/host_clock.h"
#include "sim/io/file.h"
#include "sim/io/json.h"
#include "sim/io/printable.h"
#include "sim/report/report_json.h"
#include "sim/report/table.h"
#include "tools/analysis/scene_info.h"
#include "tools/cli/verbs.h"
#include "tools/host/paths.h"
#include "tools/host/standard_streams.h"
#include "tools/run/frame/load_config.h"
#include "traces/accel/build.h"
#include "traces/scene/export.h"
#include "traces/scenes/builtin.h"
#include "traces/scenes/library.h"

namespace tools {
namespace {

/// Returns "VmRSS" (resident memory) or "VmHWM" (its peak) of this process in bytes. getrusage() would include the
/// parent program before exec.
std::uint64_t memory_in_use(const std::string& key) {
  std::ifstream status("/proc/self/status");
  for (std::string word; status >> word;) {
    std::uint64_t kib = 0;
    if (word == key + ":" && status >> kib) return kib * 1024;
  }
  return 0;
}

void print_warnings(const traces::Scene& scene) {
  for (const std::string& warning : scene.warnings) tell("warning: {}", warning);
}

void list() {
  sim::Table table({"scene", "triangles", ""});
  for (const traces::BuiltinInfo& scene : traces::builtin_scenes()) {
    table.add_row({scene.name, fmt::format("about {}", sim::si_text(scene.triangles)), scene.description});
  }
  fmt::print("{}\nworkloads (scene, camera, frames and resolution together): {}\n", table.text(),
             fmt::join(workload_names(), ", "));
}

/// A scene requested by name, workload or file.
struct Wanted {
  JobOptions job;
  traces::Scene open() const { return open(load_run_config(job)); }
  static traces::Scene open(const RunConfig& config) {
    return traces::open_scene(config.scene.name, {.triangles = config.scene.triangles}, config.limits);
  }
};

struct InfoOptions {
  Wanted scene;
  bool cameras = false, json = false;
};

void show(const InfoOptions& options) {
  SceneCost cost;
  const RunConfig config = load_run_config(options.scene.job);
  const std::uint64_t before = memory_in_use("VmRSS");
  const std::filesystem::path file = traces::scene_file(config.scene.name);
  auto begin = sim::HostClock::now();
  const traces::Scene scene = Wanted::open(config);
  cost.load_s = sim::seconds_since(begin);
  begin = sim::HostClock::now();
  const traces::MemoryImage image = traces::build_memory_image(scene, config.bvh, 0, nullptr, config.render.mip_maps);
  cost.build_s = sim::seconds_since(begin);
  cost.peak_bytes = std::max(memory_in_use("VmHWM"), before) - before;
  std::error_code ignored;
  if (!file.empty()) cost.file_bytes = std::filesystem::file_size(file, ignored);
  const sim::Json info = scene_info_json(scene, image, cost);
  fmt::print("{}", options.json ? sim::json_text(info) : scene_info_text(info, options.cameras));
  print_warnings(scene);
}

struct ExportOptions {
  Wanted scene;
  std::filesystem::path out;
  bool force = false;
};

void export_scene(const ExportOptions& options) {
  const std::string shown = sim::printable(options.out.string());
  if (options.out.extension() != ".glb") throw sim::InputError(shown + ": the name of a GLB file ends with .glb");
  std::error_code ignored;
  if (!options.force && std::filesystem::exists(options.out, ignored)) {
    throw sim::InputError(shown + " exists; --force replaces it");
  }
  sim::check_output(options.out, {.any = true});
  const traces::Scene scene = options.scene.open();
  const std::string bytes = traces::export_glb(scene);
  sim::write_file_atomically(options.out, bytes);
  print_warnings(scene);
  fmt::print("{}: {}\n", shown, sim::si_text(static_cast<double>(bytes.size()), "B"));
}

CLI::App* add_scene_verb(CLI::App& verb, const char* name, const char* description, Wanted& wanted) {
  CLI::App* sub = verb.add_subcommand(name, description);
  sub->add_option("scene", wanted.job.scene, "built-in scene, workload, or .gltf or .glb file")->required();
  sub->add_option("--set", wanted.job.sets, "change one field, e.g. scene.triangles=100000 (repeatable)")
      ->allow_extra_args(false);
  return sub;
}

}  // namespace

void add_scenes(CLI::App& app) {
  CLI::App* verb = app.add_subcommand("scenes", "What can be rendered");
  verb->require_subcommand(1);
  verb->footer("Example: raywatt scenes info teapot");

  CLI::App* all = verb->add_subcommand("list", "Built-in scenes and workloads");
  all->footer("Example: raywatt scenes list");
  all->callback([] { list(); });

  const auto asked = std::make_shared<InfoOptions>();
  CLI::App* info =
      add_scene_verb(*verb, "info", "What is in a scene, its tree, and what loading it costs", asked->scene);
  info->add_flag("--camera", asked->cameras, "also where each camera stands and looks");
  info->add_flag("--json", asked->json, "as JSON");
  info->footer("Example: raywatt scenes info teapot --camera");
  info->callback([asked] { show(*asked); });

  const auto wanted = std::make_shared<ExportOptions>();
  CLI::App* out =
      add_scene_verb(*verb, "export", "Write a scene as glTF 2.0 that passes the Khronos validator", wanted->scene);
  out->add_option("-o,--output", wanted->out, "the file, .glb")->required();
  out->add_flag("--force", wanted->force, "replace the file if it exists");
  out->footer("Example: raywatt scenes export cornell -o cornell.glb");
  out->callback([wanted] { export_scene(*wanted); });
}

}  // namespace tools
