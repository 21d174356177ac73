#include "tools/studies/bench/bench.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <optional>
#include <sstream>
#include <system_error>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <poll.h>
#include <sys/wait.h>
#include <unistd.h>

#include "sim/config/config.h"
#include "sim/error.h"
#include "sim/io/file.h"
#include "sim/io/json.h"
#include "sim/io/printable.h"
#include "sim/report/table.h"
#include "tools/analysis/report.h"
#include "tools/host/build_info.h"
#include "tools/host/process.h"
#include "tools/run/frame/run_job.h"
#include "tools/run/frame/trace_header.h"
#include "tools/run/stored_frames.h"
#include "tools/sampling/tile_sampling.h"
#include "traces/accel/bvh_tracer.h"
#include "traces/trace_file/trace_writer.h"

namespace tools {

using sim::Json;

namespace {

/// A temporary folder, removed by the destructor.
class ScratchFolder {
 public:
  ScratchFolder() {
    std::string name = (std::filesystem::temp_directory_path() / "raywatt-bench.XXXXXX").string();
    if (::mkdtemp(name.data()) == nullptr) throw sim::IoError(fmt::format("{}: cannot be made", name));
    path_ = name;
  }
  ~ScratchFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  ScratchFolder(const ScratchFolder&) = delete;
  ScratchFolder& operator=(const ScratchFolder&) = delete;
  const std::filesystem::path& folder() const { return path_; }

 private:
  std::filesystem::path path_;
};

/// Returns the conditions under which metrics are measured: scene, resolution and configuration.
Json conditions_of(const Inputs& inputs) {
  return {{"scene", inputs.scene.name},
          {"resolution", {inputs.config.render.width, inputs.config.render.height}},
          {"config_hash", sim::config_hash(inputs.config)}};
}

/// Records the rays of a frame in a trace file in `folder`, opens it for replay and removes the file.
std::unique_ptr<StoredFrames> record_trace(const Inputs& inputs, const BenchOptions& options,
                                           const std::filesystem::path& folder, Progress& progress) {
  const std::filesystem::path file = folder / "a.trace";
  traces::TraceWriter writer(file, trace_header(inputs, options.job));
  render_frame(inputs, kernels::parse_program(options.job.program), traces::BvhTracer(inputs.image),
               options.job.threads, {.progress = &progress, .trace = &writer});
  writer.end_frame(recorded_frame(inputs.frame, {}));
  writer.commit();
  JobOptions on_one_thread = options.job;
  on_one_thread.threads = 1;
  auto replay = std::make_unique<StoredFrames>(file, on_one_thread);
  std::filesystem::remove(file);
  return replay;
}

/// Measures a scene in rounds of all metrics, so that changing load of the host affects all metrics alike.
class RoundRunner {
 public:
  /// `scratch`: folder for temporary files of the benchmark.
  RoundRunner(const Inputs& inputs, const BenchOptions& options, const std::filesystem::path& scratch,
              Progress& progress)
      : inputs_(inputs),
        options_(options),
        scratch_(scratch),
        program_(kernels::parse_program(options.job.program)),
        progress_(progress) {
    const bool samples = program_.kind == kernels::ProgramSpec::Kind::kFull;
    if (samples) sampling_ = TileSampling{.full_image = false};
    progress.expect_parts(1 + (samples ? 5 : 4) * options.runs, options.job.scene);
  }

  void run() {
    const SimulateOptions extras{.progress = &progress_};
    const double picture = render_frame(inputs_, program_, traces::BvhTracer(inputs_.image), 1, extras).seconds;
    const FrameResult one = simulate_frame(inputs_, program_, 1, extras);
    const FrameResult all = simulate_frame(inputs_, program_, options_.job.threads, extras);
    rays_ = one.rays();
    steps_ = one.rendered.traversal_steps;
    const auto rays = static_cast<double>(rays_), steps = static_cast<double>(steps_);
    const double timing = one.wall_seconds - one.rendered.waited;
    add("functional_rays_per_s", rays / picture);
    add("recording_rays_per_s", rays / one.rendered.seconds);
    add("one_thread_rays_per_s", rays / one.wall_seconds);
    add("simulated_rays_per_s", rays / all.wall_seconds);
    add("steps_per_s", steps / all.wall_seconds);
    add("ns_per_step", 1e9 * timing / steps);
    add("timing_s_per_functional_s", timing / picture);
    // Peak memory is read after the whole run and before the first replay, which needs a different amount of memory.
    if (peak_mib_ == 0) peak_mib_ = peak_rss_mib();
    if (replay_ == nullptr) replay_ = record_trace(inputs_, options_, scratch_, progress_);
    replay_->go_to_first_frame();
    add("replay_s_per_timing_s", tools::run(*replay_, {.progress = &progress_}).total->wall_seconds / timing);
    if (sampling_) add_sampled_metrics(one, timing);
  }

  Json result_json() const {
    Json out = conditions_of(inputs_);
    out.update({{"triangles", inputs_.scene.triangles}, {"rays", rays_}, {"traversal_steps", steps_}});
    for (const auto& [name, values] : values_) out[name] = median(values);
    out["peak_rss_mb"] = peak_mib_;
    return out;
  }

 private:
  void add_sampled_metrics(const FrameResult& whole, double timing) {
    const FrameResult some = simulate_sampled(inputs_, program_, 1, *sampling_, &progress_);
    const double off = some.sampled->cycles.estimate - static_cast<double>(whole.cycles);
    add("sampling_speedup", whole.wall_seconds / some.wall_seconds);
    add("sampling_timing_speedup", timing / (some.wall_seconds - some.rendered.waited));
    add("sampling_cycles_error_percent", 100 * std::abs(off) / static_cast<double>(whole.cycles));
    add("sampling_cycles_inside", std::abs(off) <= some.sampled->cycles.half_width() ? 1 : 0);
  }

  void add(const char* name, double value) {
    const auto known = std::ranges::find(values_, name, [](const auto& metric) { return metric.first; });
    (known != values_.end() ? *known : values_.emplace_back(name, std::vector<double>{})).second.push_back(value);
  }

  const Inputs& inputs_;
  const BenchOptions& options_;
  const std::filesystem::path scratch_;
  const kernels::ProgramSpec program_;
  Progress& progress_;
  double peak_mib_ = 0;
  std::unique_ptr<StoredFrames> replay_;
  /// Settings of tile sampling; empty if the frame program does not support it.
  std::optional<TileSampling> sampling_;
  std::uint64_t rays_ = 0, steps_ = 0;
  std::vector<std::pair<std::string, std::vector<double>>> values_;
};

/// Measures a scene and returns its metrics. `all`: JSON members that all scenes share.
Json measure_scene(const std::string& scene, const BenchOptions& options, Json all, const Json* other,
                   const std::filesystem::path& scratch) {
  BenchOptions own = options;
  own.job.scene = scene;
  Progress progress(own.job.progress, own.job.quiet);
  const Inputs inputs = load_inputs(own.job, &progress);
  print_warnings(inputs.warnings, &progress);
  if (other != nullptr) {  // check before measuring that the results are comparable
    all["scenes"] = Json::array({conditions_of(inputs)});
    check_comparable(all, *other, options.against, options.scenes.size() == 1);
  }
  RoundRunner rounds(inputs, own, scratch, progress);
  for (std::uint32_t i = 0; i < options.runs; ++i) rounds.run();
  return rounds.result_json();
}

/// Measures a scene in a child process, so that peak memory is that of this scene. The child's main() handles
/// exceptions.
Json measure_in_child(const std::string& scene, const BenchOptions& options, const Json& all, const Json* other) {
  constexpr int kGlanceMs = 100;  // timeout of poll(), because an interrupt just before poll() does not end it
  std::string text;
  int status = 0;
  {
    const HoldInterrupts hold;  // an interrupt must not prevent the removal of the folder
    const ScratchFolder scratch;
    ChildProcess child([&] { return sim::json_line(measure_scene(scene, options, all, other, scratch.folder())); });
    for (bool is_open = true; is_open && !is_interrupted();) {
      pollfd end{child.pipe_end(), POLLIN, 0};
      if (::poll(&end, 1, kGlanceMs) > 0) is_open = child.receive_data();
    }
    if (is_interrupted()) throw Interrupted{};
    text = child.received_text();
    status = child.wait_for_exit();
  }
  if (WIFSIGNALED(status))
    throw std::runtime_error(fmt::format("signal {} while measuring {}", WTERMSIG(status), scene));
  if (WEXITSTATUS(status) != 0) std::exit(WEXITSTATUS(status));
  return sim::parse_json(text);
}

}  // namespace

const std::vector<BenchMetric>& bench_metrics() {
  using enum BenchMetric::Kind;
  static const std::vector<BenchMetric> metrics = {
      {"functional_rays_per_s", "functional rays/s"},
      {"recording_rays_per_s", "recording rays/s"},
      {"one_thread_rays_per_s", "1 thread rays/s"},
      {"simulated_rays_per_s", "all threads rays/s"},
      {"steps_per_s", "steps/s"},
      {"ns_per_step", "timing ns/step", kCost},
      {"timing_s_per_functional_s", "timing/functional", kCost},
      {"peak_rss_mb", "peak MiB", kCost},
      {"replay_s_per_timing_s", "replay/timing", kCost, true},
      {"sampling_speedup", "sampled: times faster", kTimes, true},
      {"sampling_timing_speedup", "timing times faster", kTimes, true},
      {"sampling_cycles_error_percent", "cycles off by %", kFact, true},
      {"sampling_cycles_inside", "inside the interval", kFact, true},
  };
  return metrics;
}

Json measure_scenes(const BenchOptions& options, const Json* other) {
  const BuildInfo build = build_info();
  Json out = {{"schema", "raywatt-bench/2"},
              {"git", build.git},
              {"dirty", build.dirty},
              {"compiler", build.compiler},
              {"flags", build.flags},
              {"program", kernels::parse_program(options.job.program).name()},
              {"config", options.job.config},
              {"set", options.job.sets},
              {"threads", host_threads(options.job.threads)},
              {"runs", options.runs}};
  Json scenes = Json::array();
  for (const std::string& scene : options.scenes) scenes.push_back(measure_in_child(scene, options, out, other));
  out["scenes"] = std::move(scenes);
  return out;
}

namespace {

constexpr std::uint64_t kLargestBench = 16 << 20;

/// Returns the entry of a scene in a benchmark result; null if there is none.
const Json* find_scene(const Json& bench, const Json& name) {
  const auto found = std::ranges::find(bench["scenes"], name, [](const Json& scene) { return scene["scene"]; });
  return found != bench["scenes"].end() ? &*found : nullptr;
}

/// Converts a benchmark result of schema raywatt-bench/1, which had no multi-threaded metric, to version 2.
void convert_to_version_2(Json& bench) {
  for (Json& scene : bench["scenes"]) {
    for (const auto& [was, is] : {std::pair{"functional_rays_per_s", "recording_rays_per_s"},
                                  std::pair{"simulated_rays_per_s", "one_thread_rays_per_s"}}) {
      if (!scene.contains(was)) continue;
      scene[is] = scene[was];
      scene.erase(was);
    }
    scene.erase("peak_rss_mb");  // in version 1 the peak included all earlier scenes
  }
  bench["schema"] = "raywatt-bench/2";
}

/// Returns what is wrong with the format of a benchmark result; empty if it is valid.
std::string format_error(const Json& bench) {
  if (!bench.is_object() || !bench.contains("schema") || !bench["schema"].is_string()) return "has no 'schema'";
  const std::string schema = bench["schema"].get<std::string>();
  if (schema != "raywatt-bench/1" && schema != "raywatt-bench/2") {
    return fmt::format("has schema '{}'", sim::printable(schema));
  }
  if (!bench.contains("scenes") || !bench["scenes"].is_array()) return "has no 'scenes'";
  for (const Json& scene : bench["scenes"]) {
    if (!scene.is_object() || !scene.contains("scene") || !scene["scene"].is_string()) {
      return "has a scene without a name";
    }
    for (const BenchMetric& metric : bench_metrics()) {
      if (scene.contains(metric.name) && !scene[metric.name].is_number()) {
        return fmt::format("has a '{}' that is not a number", metric.name);
      }
    }
  }
  return {};
}

/// Returns the conditions that differ between two benchmark results of a scene: "resolution [64,32] instead of
/// [32,32]".
std::vector<std::string> find_differences(const Json& a, const Json& b, const Json& scene_a, const Json& scene_b) {
  std::vector<std::string> found;
  const auto differs = [](const Json& x, const Json& y, const char* key) {
    return x.contains(key) && y.contains(key) && x[key] != y[key];
  };
  const auto compare = [&](const Json& x, const Json& y, const char* key) {
    if (!differs(x, y, key)) return;
    found.push_back(fmt::format("{} {} instead of {}", key, sim::printable(sim::json_line(y[key])),
                                sim::printable(sim::json_line(x[key]))));
  };
  compare(scene_a, scene_b, "resolution");
  compare(a, b, "program");
  compare(a, b, "threads");
  if (!found.empty() || !differs(scene_a, scene_b, "config_hash")) return found;
  compare(a, b, "config");
  compare(a, b, "set");
  // The hash is compared only for equal commits; other commits may compute it from other keys.
  if (found.empty() && !differs(a, b, "git")) compare(scene_a, scene_b, "config_hash");
  return found;
}

/// Merges several benchmark results into one with the median of each metric.
Json merge_results(const std::vector<Json>& results) {
  Json out = results.front();
  for (Json& scene : out["scenes"]) {
    for (const BenchMetric& metric : bench_metrics()) {
      std::vector<double> values;
      for (const Json& result : results) {
        const Json* same = find_scene(result, scene["scene"]);
        if (same != nullptr && same->contains(metric.name)) values.push_back((*same)[metric.name].get<double>());
      }
      if (!values.empty()) scene[metric.name] = median(values);
    }
  }
  return out;
}

std::string cell_text(const BenchMetric& metric, const Json& scene) {
  if (!scene.contains(metric.name)) return "-";
  const auto value = scene[metric.name].get<double>();
  if (metric.name == "sampling_cycles_inside") return value >= 0.5 ? "yes" : "no";
  return metric.kind == BenchMetric::Kind::kRate ? sim::si_text(value) : fmt::format("{:.2f}", value);
}

/// Returns a table of metrics with one line per scene, followed by an empty line. Empty if no scene has a metric of
/// this table. `is_partial`: selects the metrics (BenchMetric::is_partial).
std::string metrics_table(const Json& bench, bool is_partial, bool compares) {
  std::vector<BenchMetric> columns;
  for (const BenchMetric& metric : bench_metrics()) {
    const bool is_compared = metric.kind != BenchMetric::Kind::kFact;
    if (metric.is_partial == is_partial && (is_compared || !compares)) columns.push_back(metric);
  }
  std::vector<std::string> header = {compares ? "times as good" : "scene"};
  for (const BenchMetric& metric : columns) header.push_back(metric.header);
  sim::Table table(header);
  bool shows = false;
  for (const Json& scene : bench["scenes"]) {
    if (compares && !scene.contains("against")) continue;
    std::vector<std::string> row = {scene["scene"].get<std::string>()};
    for (const BenchMetric& metric : columns) {
      const Json& from = compares ? scene["against"] : scene;
      shows = shows || from.contains(metric.name);
      const bool has = compares && from.contains(metric.name);
      row.push_back(has        ? fmt::format("x{:.2f}", from[metric.name].get<double>())
                    : compares ? "-"
                               : cell_text(metric, scene));
    }
    table.add_row(row);
  }
  return shows ? table.text() + "\n" : "";
}

}  // namespace

Json load_bench(const std::filesystem::path& file) {
  const std::string name = sim::printable(file.string());
  const auto refuse = [&](const std::string& why) {
    return sim::InputError(
        fmt::format("{}: {}; allowed: output of 'raywatt bench --json', once or several times", name, why));
  };
  std::string bytes = sim::read_file(file, kLargestBench);
  if (sim::is_nested_deeper(bytes, sim::kDeepestJson))
    throw refuse(fmt::format("is nested deeper than {} levels", sim::kDeepestJson));
  std::istringstream text(std::move(bytes));
  std::vector<Json> results;
  try {
    while (text >> std::ws && text.peek() != std::char_traits<char>::eof()) {
      Json& result = results.emplace_back();
      result = sim::parse_json(text);
      if (const std::string why = format_error(result); !why.empty()) throw refuse(why);
      if (result["schema"] == "raywatt-bench/1") convert_to_version_2(result);
      for (const Json& scene : result["scenes"]) {
        const Json* same = find_scene(results.front(), scene["scene"]);
        if (same == nullptr) continue;
        const std::vector<std::string> all = find_differences(results.front(), result, *same, scene);
        if (!all.empty()) throw refuse(fmt::format("has results of different kinds: {}", fmt::join(all, ", ")));
      }
    }
  } catch (const sim::JsonError&) {
    throw refuse(text.eof() ? "ends early" : "is not JSON");
  }
  if (results.empty()) throw refuse("is empty");
  return merge_results(results);
}

void check_comparable(const Json& bench, const Json& other, const std::filesystem::path& file,
                      bool require_common_scene) {
  const std::string name = sim::printable(file.string());
  bool have_one = false;
  for (const Json& scene : bench["scenes"]) {
    const Json* same = find_scene(other, scene["scene"]);
    if (same == nullptr) continue;
    have_one = true;
    const std::vector<std::string> all = find_differences(bench, other, scene, *same);
    if (all.empty()) continue;
    throw sim::InputError(
        fmt::format("{}: cannot be compared with these metrics: {} has {}; allowed: the same frame on "
                    "the same machine",
                    name, scene["scene"].get<std::string>(), fmt::join(all, ", ")));
  }
  if (have_one || !require_common_scene) return;
  std::vector<std::string> there;
  for (const Json& scene : other["scenes"]) there.push_back(sim::printable(scene["scene"].get<std::string>()));
  throw sim::InputError(
      fmt::format("{}: has no scene in common with these metrics; its scenes: {}", name, fmt::join(there, ", ")));
}

void compare_bench(Json& bench, const Json& other) {
  for (Json& scene : bench["scenes"]) {
    const Json* same = find_scene(other, scene["scene"]);
    if (same == nullptr) continue;
    Json ratios = Json::object();
    for (const BenchMetric& metric : bench_metrics()) {
      if (metric.kind == BenchMetric::Kind::kFact) continue;
      if (!scene.contains(metric.name) || !same->contains(metric.name)) continue;
      const double ratio = scene[metric.name].get<double>() / (*same)[metric.name].get<double>();
      ratios[metric.name] = metric.kind == BenchMetric::Kind::kCost ? 1 / ratio : ratio;
    }
    scene["against"] = std::move(ratios);
  }
}

std::string bench_table(const Json& bench) {
  std::string text;
  for (const bool compares : {false, true}) {
    for (const bool is_partial : {false, true}) text += metrics_table(bench, is_partial, compares);
  }
  return text.substr(0, text.size() - 1);  // without the last empty line
}

}  // namespace tools
