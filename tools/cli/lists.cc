#include <algorithm>
#include <cctype>
#include <filesystem>
#include <fstream>
#include <memory>
#include <string_view>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include "hw_models/machines/gpu_config.h"
#include "hw_models/srp/schedule.h"
#include "shader_kernels/catalogue.h"
#include "shader_kernels/graph.h"
#include "sim/config/config.h"
#include "sim/error.h"
#include "sim/host_clock.h"
#include "sim/io/file.h"
#include "sim/io/json.h"
#include "sim/io/printable.h"
#include "sim/report/table.h"
#include "tools/analysis/info.h"
#include "tools/cli/job_options.h"
#include "tools/cli/verbs.h"
#include "tools/host/paths.h"
#include "tools/host/standard_streams.h"
#include "tools/run/frame/load_config.h"
#include "tools/run/frame/run_job.h"
#include "traces/accel/build.h"
#include "traces/scene/did_you_mean.h"
#include "traces/scene/export.h"
#include "traces/scenes/builtin.h"
#include "traces/scenes/library.h"

namespace tools {
namespace {

/// Returns one line on a configuration file: the value of its key `question`, or the first sentence of the comment at
/// its start.
std::string description_line(const std::filesystem::path& file) {
  constexpr std::size_t kLongest = 110;
  constexpr std::string_view kQuestion = "question: ";
  std::ifstream in(file);
  std::string text;
  for (std::string line; std::getline(in, line);) {
    if (line.starts_with(kQuestion)) return line.substr(kQuestion.size());
    if (line.starts_with("schema: ")) continue;
    if (!line.starts_with("# ")) break;
    text += (text.empty() ? "" : " ") + line.substr(2);
  }
  std::size_t end = text.find(". ");
  while (end != std::string::npos && std::isupper(static_cast<unsigned char>(text[end + 2])) == 0) {
    end = text.find(". ", end + 2);
  }
  text = text.substr(0, end);
  if (text.ends_with('.')) text.pop_back();
  return text.size() <= kLongest ? text : text.substr(0, text.rfind(' ', kLongest)) + " ...";
}

/// True if an experiment file is for `raywatt optimise`; other experiments are sweeps.
bool is_search(const std::string& name) {
  std::ifstream in(find_config_file(name));
  std::string line;
  return std::getline(in, line) && line.starts_with("schema: raywatt-optimise/");
}

/// Returns a list of the configuration files by kind, with one line about each.
std::string config_list() {
  std::string text;
  const auto list = [&](const std::string& head, const std::vector<std::string>& names) {
    if (names.empty()) return;
    std::size_t width = 0;
    for (const std::string& name : names) width = std::max(width, name.size());
    text += fmt::format("{}{}\n", text.empty() ? "" : "\n", head);
    for (const std::string& name : names) {
      const std::string about = sim::printable(description_line(find_config_file(name)));
      text += about.empty() ? fmt::format("  {}\n", name) : fmt::format("  {:<{}}  {}\n", name, width, about);
    }
  };
  list("configurations (raywatt run NAME)", config_names());
  list("memory grades (--set dram.extends=NAME)", config_names_in("dram"));
  list("energy tables (--set energy.extends=NAME)", config_names_in("energy"));
  list("voltages over clocks (--set power.extends=NAME)", config_names_in("power"));
  list("cache latencies over size (--set latency.extends=NAME)", config_names_in("latency"));
  list("area tables (--set area.extends=NAME)", config_names_in("area"));
  std::vector<std::string> searches = config_names_in("experiments");
  // std::ranges subranges do not compile with clang 14.
  const auto sweeps = std::stable_partition(searches.begin(), searches.end(), is_search);
  list("sweeps (raywatt sweep run NAME; without experiments/)", {sweeps, searches.end()});
  list("searches (raywatt optimise NAME; without experiments/)", {searches.begin(), sweeps});
  list("features (raywatt worth NAME; without worth/)", config_names_in("worth"));
  return text;
}

/// Throws InputError if the argument of `raywatt config show` is a configuration key instead of a configuration.
void reject_key_argument(const std::string& name) {
  if (std::ranges::count(config_names(), name) != 0) return;
  for (const sim::FieldInfo& field : sim::list_fields(RunConfig())) {
    const bool is_key = field.path == name;
    if (!is_key && !field.path.starts_with(name + ".")) continue;
    const std::string how = is_key ? fmt::format("; raywatt config show --set {}=VALUE changes it", name) : "";
    throw sim::InputError(
        fmt::format("'{}' is a {}, not a configuration; allowed: raywatt config show, which prints all keys{}", name,
                    is_key ? "key" : "group of keys", how));
  }
}

}  // namespace

void add_config_command(CLI::App& app) {
  CLI::App* verb = app.add_subcommand("config", "Show configurations and their keys");
  verb->require_subcommand(1);
  verb->footer("Example: raywatt config show sgrt-2016 --set cores=2");
  CLI::App* list = verb->add_subcommand(
      "list", "List configurations, memory grades, tables of energy, power, area and latency, and experiments");
  list->footer("Example: raywatt config list");
  list->callback([] { fmt::print("{}", config_list()); });
  CLI::App* show = verb->add_subcommand("show", "Show the effective configuration: every key with its meaning");
  const auto options = std::make_shared<JobOptions>();
  add_config_options(*show, options->config, options->sets);
  show->footer("Example: raywatt config show sgrt-2016 --set cores=2");
  show->callback([options] {
    reject_key_argument(options->config);
    fmt::print("{}", sim::dump_config(load_run_config(*options)));
    print_technology_table_warnings(*options);
  });
  CLI::App* schema = verb->add_subcommand("schema", "Print a JSON Schema of configuration files");
  schema->footer("Example: raywatt config schema > schema.json");
  schema->callback([] { fmt::print("{}", sim::json_lines(sim::config_schema<RunConfig>())); });
  CLI::App* manual = verb->add_subcommand(
      "manual", "Print every key: value in sgrt-2016, unit, range, what it affects, meaning (Markdown)");
  manual->footer("Example: raywatt config manual > manual.md");
  manual->callback([] { fmt::print("{}", sim::config_manual(load_run_config(JobOptions{}))); });
}

namespace {

void print_kernels(const JobOptions& options) {
  const hw::SrpConfig srp = load_run_config(options).gpu->srp;
  sim::Table table({"kernel", "operations", "on units", "II", "depth", "local reads", "writes", "cached loads", ""});
  for (const kernels::KernelInfo& kernel : kernels::kernel_catalogue()) {
    const hw::KernelSchedule s = hw::schedule_kernel(kernel.graph, srp);
    table.add_row({std::string(kernel.name), std::to_string(kernels::count_executed_ops(kernel.graph)),
                   std::to_string(s.fu_ops), std::to_string(s.ii), std::to_string(s.depth),
                   std::to_string(s.local_reads), std::to_string(s.local_writes), std::to_string(s.cached_loads),
                   std::string(kernel.meaning)});
  }
  fmt::print("{}", table.text());
}

void print_kernel(const JobOptions& options, const std::string& name) {
  const kernels::KernelInfo* kernel = kernels::find_kernel(name);
  if (kernel == nullptr) {
    std::vector<std::string> names;
    for (const kernels::KernelInfo& k : kernels::kernel_catalogue()) names.emplace_back(k.name);
    throw sim::InputError(fmt::format("no kernel is called '{}'{}; see raywatt kernels list", sim::printable(name),
                                      traces::did_you_mean(name, names)));
  }
  const hw::KernelSchedule s = hw::schedule_kernel(kernel->graph, load_run_config(options).gpu->srp);
  fmt::print("{}: {}\n\nII {} (units and ports allow {}), depth {}, {} operations on units\n\n{}\n{}", kernel->name,
             kernel->meaning, s.ii, s.res_mii, s.depth, s.fu_ops, kernels::operation_summary(kernel->graph),
             kernels::node_listing(kernel->graph));
}

}  // namespace

void add_kernels_command(CLI::App& app) {
  CLI::App* verb = app.add_subcommand("kernels", "Show the kernels of the shader cores");
  verb->require_subcommand(1);
  verb->footer("Example: raywatt kernels show shade_diffuse");
  const auto options = std::make_shared<JobOptions>();
  CLI::App* all = verb->add_subcommand("list", "List kernels with their schedules on a configuration's array");
  add_config_options(*all, options->config, options->sets);
  all->footer("Example: raywatt kernels list --set srp.array.cache_ports=2");
  all->callback([options] { print_kernels(*options); });
  CLI::App* one = verb->add_subcommand("show", "Show a kernel's dataflow graph and schedule");
  const auto name = std::make_shared<std::string>();
  one->add_option("kernel", *name, "name of the kernel")->required();
  add_config_options(*one, options->config, options->sets);
  one->footer("Example: raywatt kernels show shade_diffuse");
  one->callback([options, name] { print_kernel(*options, *name); });
}

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
  for (const std::string& warning : scene.warnings) print_message("warning: {}", warning);
}

void print_scenes() {
  sim::Table table({"scene", "triangles", ""});
  for (const traces::BuiltinInfo& scene : traces::builtin_scenes()) {
    table.add_row({scene.name, fmt::format("about {}", sim::si_text(scene.triangles)), scene.description});
  }
  fmt::print("{}\nworkloads (scene, camera, frames and resolution together): {}\n", table.text(),
             fmt::join(workload_names(), ", "));
}

/// A scene given on the command line: a built-in scene, a workload or a file.
struct SceneArgument {
  JobOptions job;
  traces::Scene open_scene() const { return open_scene(load_run_config(job)); }
  static traces::Scene open_scene(const RunConfig& config) {
    return traces::open_scene(config.scene.name, {.triangles = config.scene.triangles}, config.limits);
  }
};

struct InfoOptions {
  SceneArgument scene;
  bool cameras = false, json = false;
};

void print_scene(const InfoOptions& options) {
  SceneCost cost;
  const RunConfig config = load_run_config(options.scene.job);
  const std::uint64_t before = memory_in_use("VmRSS");
  const std::filesystem::path file = traces::scene_file(config.scene.name);
  auto begin = sim::HostClock::now();
  const traces::Scene scene = SceneArgument::open_scene(config);
  cost.load_s = sim::seconds_since(begin);
  begin = sim::HostClock::now();
  const traces::MemoryImage image =
      traces::build_memory_image(scene, config.bvh, 0, nullptr, config.render.mip_maps, config.render.roughness());
  cost.build_s = sim::seconds_since(begin);
  cost.peak_bytes = std::max(memory_in_use("VmHWM"), before) - before;
  std::error_code ignored;
  if (!file.empty()) cost.file_bytes = std::filesystem::file_size(file, ignored);
  const sim::Json info = scene_info_json(scene, image, config.bvh, cost);
  fmt::print("{}", options.json ? sim::json_lines(info) : scene_info_text(info, options.cameras));
  print_warnings(scene);
}

struct ExportOptions {
  SceneArgument scene;
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
  const traces::Scene scene = options.scene.open_scene();
  const std::string bytes = traces::export_glb(scene);
  sim::write_file_atomically(options.out, bytes);
  print_warnings(scene);
  fmt::print("{}: {}\n", shown, sim::si_text(static_cast<double>(bytes.size()), "B"));
}

CLI::App* add_scene_verb(CLI::App& verb, const char* name, const char* description, SceneArgument& wanted) {
  CLI::App* sub = verb.add_subcommand(name, description);
  sub->add_option("scene", wanted.job.scene, "built-in scene, workload, or .gltf or .glb file")->required();
  sub->add_option("--set", wanted.job.sets, "set a configuration key, e.g. scene.triangles=100000 (repeatable)")
      ->allow_extra_args(false);
  return sub;
}

}  // namespace

void add_scenes_command(CLI::App& app) {
  CLI::App* verb = app.add_subcommand("scenes", "List, describe and export scenes");
  verb->require_subcommand(1);
  verb->footer("Example: raywatt scenes info teapot");

  CLI::App* all = verb->add_subcommand("list", "List built-in scenes and workloads");
  all->footer("Example: raywatt scenes list");
  all->callback([] { print_scenes(); });

  const auto asked = std::make_shared<InfoOptions>();
  CLI::App* info =
      add_scene_verb(*verb, "info", "Describe a scene, its tree, and the cost of loading it", asked->scene);
  info->add_flag("--camera", asked->cameras, "also print position and direction of each camera");
  info->add_flag("--json", asked->json, "print JSON");
  info->footer("Example: raywatt scenes info teapot --camera");
  info->callback([asked] { print_scene(*asked); });

  const auto wanted = std::make_shared<ExportOptions>();
  CLI::App* out =
      add_scene_verb(*verb, "export", "Write a scene as glTF 2.0 that passes the Khronos validator", wanted->scene);
  out->add_option("-o,--output", wanted->out, "the file (.glb)")->required();
  out->add_flag("--force", wanted->force, "replace the file if it exists");
  out->footer("Example: raywatt scenes export cornell -o cornell.glb");
  out->callback([wanted] { export_scene(*wanted); });
}

}  // namespace tools
