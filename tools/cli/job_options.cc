#include "tools/cli/job_options.h"

#include <charconv>
#include <cmath>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "hw_models/machines/gpu_config.h"
#include "sim/io/printable.h"
#include "tools/host/standard_streams.h"
#include "tools/run/frame/load_config.h"

namespace tools {

void add_progress_option(CLI::App& verb, std::string& progress) {
  verb.add_option(
          "--progress", progress,
          "auto: show a bar on a terminal after two seconds; json: write lines of JSON to standard error; none:\n"
          "show nothing")
      ->check(CLI::IsMember({"auto", "json", "none"}))
      ->capture_default_str();
}

void add_config_options(CLI::App& verb, std::string& config, std::vector<std::string>& sets) {
  verb.add_option("config", config, "configuration: a name such as sgrt-2016, or a .yaml file")->capture_default_str();
  add_set_option(verb, sets);
}

void add_set_option(CLI::App& verb, std::vector<std::string>& sets) {
  verb.add_option("--set", sets,
                  "set a configuration key: KEY=VALUE, e.g. cores=2 or tni.trv.l1.size='32 KiB' (repeatable)")
      ->allow_extra_args(false)
      ->check({[](const std::string& set) {
                 const bool is_key = !set.empty() && set.find('=') == std::string::npos;
                 return is_key ? fmt::format("'{0}' has no value; allowed: KEY=VALUE, e.g. --set {0}=2",
                                             sim::printable(set))
                               : std::string();
               },
               ""});
}

/// Validator that rejects empty values, which usually come from an unset shell variable.
static CLI::Validator not_empty(const std::string& allowed) {
  return {[allowed](const std::string& value) { return value.empty() ? allowed : std::string(); }, ""};
}

void add_work_options(CLI::App& verb, JobOptions& options, bool positional) {
  if (positional) {
    add_config_options(verb, options.config, options.sets);
  } else {
    add_set_option(verb, options.sets);
  }
  verb.add_option("--scene", options.scene,
                  "built-in scene, workload (.yaml), or .gltf or .glb file (default: cornell)")
      ->check(not_empty("allowed: a name"));
  verb.add_option("--camera", options.camera, "camera of the scene, by name or index (default: the first)");
  verb.add_option(
          "--program", options.program,
          "frame program: full:N traces N samples per pixel (N a square), path:N N paths; multirate:under, "
          "multirate:super,\n"
          "undersample and supersample trace only samples whose neighbours differ; reconstruct and reconstruct:sraa\n"
          "shade one sample per pixel and use the geometry of four (docs/adaptive.md)")
      ->capture_default_str();
  verb.add_option("--resolution", options.resolution, "WIDTHxHEIGHT (default: the configuration's, 1024x512)");
  verb.add_option("--threads", options.threads, "host threads (default: all cores)")->check(CLI::Range(1, 1024));
}

void add_frames_option(CLI::App& verb, JobOptions& options) {
  verb.add_option("--frames", options.frames, "frames of an animation: A:B (both included), or A (default: 0)");
}

void add_fps_option(CLI::App& verb, std::vector<std::string>& sets) {
  require_positive(*verb.add_option_function<std::string>(
                            "--fps", [&sets](const std::string& fps) { sets.push_back("frame.fps=" + fps); },
                            "target frame rate: also report power_at_fps_w, fps_margin and the clocks that suffice\n"
                            "(docs/frame-rate.md); with thermal.minutes no frame begins earlier")
                        ->type_name("NUMBER"));
}

void add_ideal_option(CLI::App& verb, JobOptions& options) {
  std::vector<std::string> names;
  for (const hw::IdealConfig::Resource& resource : hw::IdealConfig::kResources) names.emplace_back(resource.name);
  verb.add_option("--ideal", options.ideal,
                  "make this resource ideal, to get an upper bound of performance (repeatable, or separated by commas)")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->check(CLI::IsMember(names));
}

void add_output_options(CLI::App& verb, JobOptions& options) {
  verb.add_option("-o,--output", options.out, "folder for the results (default: a dated one below raywatt-out/)")
      ->check(not_empty("allowed: a folder"));
  verb.add_flag("--force", options.force, "write into the folder even if it has other files, which are kept");
  verb.add_flag("--quiet", options.quiet, "print no table and no progress bar");
  add_progress_option(verb, options.progress);
}

void add_intervals_option(CLI::App& verb, JobOptions& options) {
  verb.add_option_function<std::string>(
          "--intervals", [&options](const std::string& choice) { options.intervals = choice == "on"; },
          "on: write the counters of every unit over time to intervals.bin.zst (docs/intervals.md); off: do not\n"
          "write it")
      ->check(CLI::IsMember({"on", "off"}))
      ->default_str("on");
}

void add_rays_option(CLI::App& verb, JobOptions& options) {
  CLI::Option* rays = verb.add_option(
      "--rays", options.rays,
      "trace the rays of this file on the T&I units only; a ray is 8 floats: origin, t_min, direction, t_max");
  for (const char* other : {"--program", "--camera", "--resolution", "--frames", "--reference", "--record",
                            "--debug-images", "--tile-sampling", "--representative", "--slices", "--image",
                            "--replicates", "--intervals", "--watch", "--timeline", "--fps"}) {
    if (CLI::Option* option = verb.get_option_no_throw(other)) rays->excludes(option);
  }
  verb.add_flag("--any-hit", options.any_hit, "rays of --rays end at their first hit, as shadow rays do")->needs(rays);
}

void add_timeline_option(CLI::App& verb, JobOptions& options) {
  verb.add_option(
          "--timeline", options.timeline,
          "also write a timeline of the first frame for ui.perfetto.dev (timeline.pftrace, at most 32 MiB): activity\n"
          "of the cores during these tiles: slowest:N, tile:X,Y (column and row), pixel:X,Y, all (docs/timeline.md)")
      ->check(not_empty("allowed: slowest:8, tile:X,Y, pixel:X,Y, all"));
}

void add_reference_option(CLI::App& verb, JobOptions& options) {
  verb.add_option("--reference", options.reference,
                  "also run this program, and report PSNR and metrics relative to it");
}

void add_launcher_options(CLI::App& verb, LauncherOptions& options) {
  verb.add_option("--launcher", options.launcher, "local: processes on this host; slurm: a job array")
      ->check(CLI::IsMember({"local", "slurm"}))
      ->capture_default_str();
  verb.add_option(
          "-j,--jobs", options.jobs,
          "local: number of points computed concurrently (default: all cores); slurm: maximum number of concurrent\n"
          "tasks")
      ->check(CLI::Range(1, 1024));
  verb.add_option("--slurm-args", options.slurm_arguments,
                  "slurm: options for sbatch, e.g. --slurm-args \"--partition=short --time=1:00:00\"")
      ->allow_extra_args(false);
  verb.add_option("--chunk", options.chunk,
                  "slurm: points per task (default: points are divided among a hundred tasks)")
      ->check(CLI::Range(1, 1'000'000));
  verb.add_flag("--retry-failed", options.retry_failed, "compute failed points again");
}

void refuse_empty_values(CLI::App& app) {
  for (CLI::Option* option : app.get_options()) {
    if (option->get_items_expected_max() == 0 || option->check_lname("set")) continue;
    const std::string allowed = option->get_required() ? "a value" : "a value, or to leave it out";
    option->check({[allowed](const std::string& value) {
                     return value.empty() ? "is empty; allowed: " + allowed : std::string();
                   },
                   ""});
  }
  for (CLI::App* verb : app.get_subcommands([](CLI::App*) { return true; })) refuse_empty_values(*verb);
}

void print_technology_table_warnings(const JobOptions& options) {
  for (const std::string& line : technology_table_warnings(load_run_config(options)))
    print_message("warning: {}", line);
}

void require_positive(CLI::Option& option) {
  option.check({[](const std::string& value) {
                  double number = 0;
                  const auto [end, error] = std::from_chars(value.data(), value.data() + value.size(), number);
                  const bool is_number = error == std::errc{} && end == value.data() + value.size();
                  if (is_number && number > 0 && std::isfinite(number)) return std::string();
                  return fmt::format("'{}' is {}; allowed: a number above 0", sim::printable(value),
                                     is_number ? "out of range" : "no number");
                },
                ""});
}

void refuse_negative(CLI::Option& option) {
  option.check({[](const std::string& value) {
                  return value.starts_with('-') ? value + " is negative; allowed: a whole number from 0 on"
                                                : std::string();
                },
                ""});
}

}  // namespace tools
