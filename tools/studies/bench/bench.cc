#include "tools/studies/bench/bench.h"

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <optional>
#include <system_error>

#include <fmt/format.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include "sim/config/config.h"
#include "sim/error.h"
#include "sim/io/json.h"
#include "tools/analysis/report.h"
#include "tools/host/build_info.h"
#include "tools/host/interrupt.h"
#include "tools/run/frame/run_job.h"
#include "tools/run/frame/trace_header.h"
#include "tools/run/stored_frames.h"
#include "tools/sampling/tile_sampling.h"
#include "traces/accel/bvh_tracer.h"
#include "traces/trace_file/trace_writer.h"

namespace tools {

using sim::Json;

namespace {

/// A folder that goes with whoever has it.
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
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

/// The subject of a scene's figures.
Json conditions_of(const Inputs& inputs) {
  return {{"scene", inputs.scene.name},
          {"resolution", {inputs.config.render.width, inputs.config.render.height}},
          {"config_hash", sim::config_hash(inputs.config)}};
}

/// The work of a frame as a trace, written into `folder`. The file has no name any more when this is there.
std::unique_ptr<StoredFrames> recorded(const Inputs& inputs, const BenchOptions& options,
                                       const std::filesystem::path& folder, Progress& progress) {
  const std::filesystem::path file = folder / "a.trace";
  traces::TraceWriter writer(file, trace_header(inputs, options.job));
  render_frame(inputs, kernels::parse_program(options.job.program), traces::BvhTracer(inputs.image),
               options.job.threads, {.progress = &progress, .trace = &writer});
  writer.end_frame(recorded_frame(inputs.frame, 0));
  writer.commit();
  JobOptions on_one_thread = options.job;
  on_one_thread.threads = 1;
  auto replay = std::make_unique<StoredFrames>(file, on_one_thread);
  std::filesystem::remove(file);
  return replay;
}

/// A round: everything once, one after the other, so that figures can be compared whatever the host is doing.
class Rounds {
 public:
  /// `scratch`: a folder to write into.
  Rounds(const Inputs& inputs, const BenchOptions& options, const std::filesystem::path& scratch, Progress& progress)
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
    // Peak memory is that of whole runs.
    if (peak_mib_ == 0) peak_mib_ = peak_rss_mib();
    if (replay_ == nullptr) replay_ = recorded(inputs_, options_, scratch_, progress_);
    replay_->go_to_first_frame();
    add("replay_s_per_timing_s", tools::run(*replay_, {.progress = &progress_}).total->wall_seconds / timing);
    if (sampling_) add_sampled(one, timing);
  }

  Json json() const {
    Json out = conditions_of(inputs_);
    out.update({{"triangles", inputs_.scene.triangles}, {"rays", rays_}, {"traversal_steps", steps_}});
    for (const auto& [name, values] : values_) out[name] = median(values);
    out["peak_rss_mb"] = peak_mib_;
    return out;
  }

 private:
  void add_sampled(const FrameResult& whole, double timing) {
    const FrameResult some = simulate_sampled(inputs_, program_, 1, *sampling_, &progress_);
    const double off = some.sampled->cycles.estimate - static_cast<double>(whole.cycles);
    add("sampling_speedup", whole.wall_seconds / some.wall_seconds);
    add("sampling_timing_speedup", timing / (some.wall_seconds - some.rendered.waited));
    add("sampling_cycles_error_percent", 100 * std::abs(off) / static_cast<double>(whole.cycles));
    add("sampling_cycles_inside", std::abs(off) <= some.sampled->cycles.half_width() ? 1 : 0);
  }

  void add(const char* name, double value) {
    const auto known = std::ranges::find(values_, name, [](const auto& figure) { return figure.first; });
    (known != values_.end() ? *known : values_.emplace_back(name, std::vector<double>{})).second.push_back(value);
  }

  const Inputs& inputs_;
  const BenchOptions& options_;
  const std::filesystem::path scratch_;
  const kernels::ProgramSpec program_;
  Progress& progress_;
  double peak_mib_ = 0;
  std::unique_ptr<StoredFrames> replay_;
  std::optional<TileSampling> sampling_;  ///< for programs whose tiles can be sampled
  std::uint64_t rays_ = 0, steps_ = 0;
  std::vector<std::pair<std::string, std::vector<double>>> values_;
};

/// `all`: what holds for all scenes, without them.
Json measure(const std::string& scene, const BenchOptions& options, Json all, const Json* other,
             const std::filesystem::path& scratch) {
  BenchOptions own = options;
  own.job.scene = scene;
  Progress progress(own.job.progress, own.job.quiet);
  const Inputs inputs = load_inputs(own.job, &progress);
  print_warnings(inputs.warnings, &progress);
  if (other != nullptr) {  // before the time is spent
    all["scenes"] = Json::array({conditions_of(inputs)});
    check_comparable(all, *other, options.against, options.scenes.size() == 1);
  }
  Rounds rounds(inputs, own, scratch, progress);
  for (std::uint32_t i = 0; i < options.runs; ++i) rounds.run();
  return rounds.json();
}

void write_all(int file, std::string_view text) {
  while (!text.empty()) {
    const ssize_t written = ::write(file, text.data(), text.size());
    if (written < 0) throw std::system_error(errno, std::generic_category(), "pipe");
    text.remove_prefix(static_cast<std::size_t>(written));
  }
}

/// All that comes, or what has come by an interrupt.
std::string read_all(int file) {
  constexpr int kGlanceMs = 100;  // at an interrupt that came just before the wait
  std::string text;
  char part[4096];
  while (!is_interrupted()) {
    pollfd waited{file, POLLIN, 0};
    if (::poll(&waited, 1, kGlanceMs) <= 0) continue;  // an interrupt ends this
    const ssize_t n = ::read(file, part, sizeof part);
    if (n == 0) break;
    if (n > 0) text.append(part, static_cast<std::size_t>(n));
    if (n < 0 && errno != EINTR) throw std::system_error(errno, std::generic_category(), "pipe");
  }
  return text;
}

/// A process that measures, and what it has to say. What measure() throws goes to main() there, which says so and ends
/// the process.
class Measuring {
 public:
  Measuring(const std::string& scene, const BenchOptions& options, const Json& all, const Json* other,
            const std::filesystem::path& scratch) {
    int ends[2];
    if (::pipe(ends) != 0) throw std::system_error(errno, std::generic_category(), "pipe");
    child_ = ::fork();
    if (child_ < 0) throw std::system_error(errno, std::generic_category(), "fork");
    if (child_ == 0) {
      ::prctl(PR_SET_PDEATHSIG, SIGKILL);
      for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {  // the parent says it
        if (std::signal(signal, SIG_DFL) == SIG_IGN) std::signal(signal, SIG_IGN);
      }
      ::close(ends[0]);
      write_all(ends[1], sim::json_line(measure(scene, options, all, other, scratch)));
      std::_Exit(0);
    }
    ::close(ends[1]);
    from_child_ = ends[0];
  }
  ~Measuring() {
    ::close(from_child_);
    if (child_ > 0) ::kill(child_, SIGKILL), wait();
  }
  Measuring(const Measuring&) = delete;
  Measuring& operator=(const Measuring&) = delete;

  /// Interrupted if an interrupt waits.
  std::string result() {
    std::string text = read_all(from_child_);
    if (is_interrupted()) throw Interrupted{};
    return text;
  }
  /// Its end, as waitpid() tells it.
  int wait() {
    int status = 0;
    while (::waitpid(child_, &status, 0) < 0 && errno == EINTR) {
    }
    child_ = -1;
    return status;
  }

 private:
  pid_t child_ = -1;
  int from_child_ = -1;
};

/// measure() in a process of its own, so that peak memory is that of the scene.
Json measure_apart(const std::string& scene, const BenchOptions& options, const Json& all, const Json* other) {
  std::string text;
  int status = 0;
  {
    const HoldInterrupts hold;  // until the folder is gone
    const ScratchFolder scratch;
    Measuring process(scene, options, all, other, scratch.path());
    text = process.result();
    status = process.wait();
  }
  if (WIFSIGNALED(status))
    throw std::runtime_error(fmt::format("signal {} while measuring {}", WTERMSIG(status), scene));
  if (WEXITSTATUS(status) != 0) std::exit(WEXITSTATUS(status));
  return sim::parse_json(text);
}

}  // namespace

const std::vector<BenchFigure>& bench_figures() {
  using enum BenchFigure::Kind;
  static const std::vector<BenchFigure> figures = {
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
  return figures;
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
  for (const std::string& scene : options.scenes) scenes.push_back(measure_apart(scene, options, out, other));
  out["scenes"] = std::move(scenes);
  return out;
}

}  // namespace tools
