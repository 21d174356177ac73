#include <algorithm>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <iterator>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include <fmt/format.h>

#include "hw_models/dram/dram_energy.h"
#include "hw_models/machines/gpu_config.h"
#include "hw_models/memory/observer.h"
#include "sim/error.h"
#include "sim/host_clock.h"
#include "sim/io/json.h"
#include "sim/io/printable.h"
#include "sim/report/energy.h"
#include "sim/report/table.h"
#include "sim/unit_report.h"
#include "tools/analysis/picture.h"
#include "tools/analysis/report.h"
#include "tools/analysis/top_down.h"
#include "tools/host/parallel.h"
#include "tools/host/process.h"
#include "tools/host/progress.h"
#include "tools/host/run_folder.h"
#include "tools/host/standard_streams.h"
#include "tools/run/frame/front_end.h"
#include "tools/run/frame/host_time.h"
#include "tools/run/frame/load_config.h"
#include "tools/run/frame/power.h"
#include "tools/run/frame/trace_header.h"
#include "tools/run/jobs.h"
#include "tools/run/run.h"
#include "tools/tiles/heat_map.h"
#include "traces/scene/images.h"
#include "traces/trace_file/trace_writer.h"

namespace tools {
namespace {

/// A finished frame and the pictures to write.
struct FramePictures {
  const SimulatedFrame& played;
  const kernels::ProgramSpec& program;
  bool has_picture = true;  ///< false if tile sampling did not render all tiles
  bool debug = false;       ///< also write debug pictures
};

/// The picture files of a frame, each written by a separate job.
class PictureFiles {
 public:
  PictureFiles(const std::filesystem::path& folder, const FramePictures& of)
      : folder_(folder),
        of_(of),
        width_(of.played.inputs.config.render.width),
        height_(of.played.inputs.config.render.height) {}

  /// Returns the jobs that write the picture files, with the slowest job first.
  std::vector<std::function<void()>> picture_jobs() {
    const std::vector<float>& rgb = of_.played.frame.rendered.rgb;
    if (of_.played.is_first && of_.has_picture && !of_.played.frame.is_partial()) add_exr("image.exr", rgb);
    if (of_.played.is_first && of_.played.reference != nullptr)
      add_exr("reference.exr", of_.played.reference->rendered.rgb);
    if (of_.played.is_first && of_.has_picture) add_png("image.png", [&rgb] { return to_rgb8(rgb); });
    if (of_.played.is_first && of_.played.reference != nullptr) add_comparison(rgb, of_.played.reference->rendered.rgb);
    if (of_.played.inputs.frames() > 1 && of_.has_picture) {
      add_png(fmt::format("frame-{:04}.png", of_.played.inputs.frame), [&rgb] { return to_rgb8(rgb); });
    }
    if (of_.played.is_first && !of_.played.frame.is_partial() && !of_.played.frame.rendered.pixels.empty()) {
      add_job(
          [this] { write_pixels(folder_ / kPixelsFile, of_.played.frame.rendered.pixels, width_, height_, notes_); });
    }
    add_debug_pictures();
    return std::move(jobs_);
  }

 private:
  void add_job(std::function<void()> job) { jobs_.push_back(std::move(job)); }
  void add_exr(const char* name, const std::vector<float>& rgb) {
    add_job([this, name, &rgb] { traces::write_exr(folder_ / name, width_, height_, rgb); });
  }
  void add_png(std::string name, std::function<std::vector<std::uint8_t>()> rgb8) {
    add_job([this, name = std::move(name), rgb8 = std::move(rgb8)] {
      traces::write_png(folder_ / name, width_, height_, rgb8());
    });
  }
  void add_comparison(const std::vector<float>& rgb, const std::vector<float>& reference) {
    add_png("reference.png", [&reference] { return to_rgb8(reference); });
    add_png("difference.png", [&rgb, &reference] { return difference_rgb8(rgb, reference); });
  }
  void add_debug_pictures() {
    const Inputs& inputs = of_.played.inputs;
    const std::string prefix = inputs.frames() > 1 ? fmt::format("frame-{:04}-", inputs.frame) : "";
    if (of_.debug && of_.played.tiles != nullptr && !of_.played.frame.rendered.pixels.empty()) {
      add_job([this, prefix] {
        write_heat_maps(folder_, prefix, heat_maps(of_.played.frame, *of_.played.tiles, width_, height_), notes_);
      });
    }
    std::vector<DebugPicture> pictures = debug_pictures(of_.program, of_.played.frame.rendered, width_, height_);
    if (of_.debug && inputs.config.render.primary == kernels::Primary::kRaster) {
      std::vector<DebugPicture> more = raster_pictures(inputs.image, inputs.camera, inputs.config.render);
      std::ranges::move(more, std::back_inserter(pictures));
    }
    for (DebugPicture& p : pictures) {
      add_job([this, prefix, p = std::move(p)] {
        traces::write_png(folder_ / fmt::format("{}debug-{}.png", prefix, p.name), p.width, p.height, p.rgb);
      });
    }
  }

  const std::filesystem::path folder_;
  const FramePictures& of_;
  const std::uint32_t width_, height_;
  const std::vector<traces::ImageNote> notes_ = notes_of(of_.played.inputs, of_.program);
  std::vector<std::function<void()>> jobs_;
};

/// Writes the frame's pictures: image, reference, difference, costs of pixels and tiles, debug pictures. Uses up to
/// `threads` threads. Throws IoError if a file cannot be written.
void write_pictures(const std::filesystem::path& folder, const FramePictures& of, std::size_t threads) {
  PictureFiles files(folder, of);
  const std::vector<std::function<void()>> jobs = files.picture_jobs();
  parallel_for(jobs.size(), threads, [&](std::size_t i, std::size_t) { jobs[i](); });
}

/// Returns a picture scaled down by averaging pixels to at most the given size. Small pictures keep their size.
SmallPicture scale_down(std::span<const float> rgb, std::size_t width, std::size_t height, std::size_t most_width,
                        std::size_t most_height) {
  const std::size_t factor =
      std::max({std::size_t{1}, (width + most_width - 1) / most_width, (height + most_height - 1) / most_height});
  SmallPicture small{width / factor, height / factor, {}};
  if (small.width == 0 || small.height == 0) return {};
  std::vector<float> means(3 * small.width * small.height);
  for (std::size_t y = 0; y < small.height * factor; ++y) {
    for (std::size_t x = 0; x < small.width * factor; ++x) {
      float* mean = &means[3 * (y / factor * small.width + x / factor)];
      for (std::size_t c = 0; c < 3; ++c) mean[c] += rgb[3 * (y * width + x) + c];
    }
  }
  for (float& mean : means) mean /= static_cast<float>(factor * factor);
  small.rgb = to_rgb8(means);
  return small;
}

/// Live view of a run: picture so far, utilisation and power of the last interval.
///
///   simulation thread: on_event() at a tile end, on request ──► copies ──► display thread: lines(), picture()
class LiveRun final : public View, public hw::Observer {
 public:
  /// Sets the configuration of the frames to show.
  void set_config(const RunConfig& config) {
    const std::lock_guard lock(mutex_);
    energy_ = config.energy;
    device_ = hw::dram_energy_events(config.gpu->dram);
    scales_ = power_scales(config);
    width_ = config.render.width;
    height_ = config.render.height;
  }

  void begin_frame(const StartedFrame& frame) {
    const std::lock_guard lock(mutex_);
    front_end_ = &frame.front_end;
    units_ = frame.units;
    formula_ = std::make_unique<sim::EnergyFormula>(units_, energy_, device_, 0, scales_);
    intervals_ = frame.intervals;
    before_.clear();
    row_.clear();
  }

  void on_event(const hw::Event& event) override {
    if (requested_.load(std::memory_order_relaxed) && std::holds_alternative<hw::TileFinished>(event)) copy_frame();
  }

  std::vector<std::string> lines() override {
    const std::lock_guard lock(mutex_);
    requested_ = true;
    if (row_.empty()) return {};
    const double watts = (energy_until_pj(row_, end_) - energy_until_pj(before_, begin_)) /
                         static_cast<double>(end_ - begin_) * sim::kWattsPerPicojouleOverFemtosecond;
    sim::set_each_value(units_,
                        [&](std::uint64_t& value, std::size_t i, sim::CounterKind) { value = row_[i] - before_[i]; });
    const Utilisation used = utilisation_of(units_);
    return {fmt::format("T&I {:.0f} %  SRP {:.0f} %  DRAM {:.0f} %  {:.2f} W  at {:.0f} us of simulated time",
                        100 * used.tni, 100 * used.srp, 100 * used.dram, watts,
                        static_cast<double>(end_) / sim::kFemtosecondsPerMicrosecond)};
  }

  SmallPicture picture(std::size_t width, std::size_t height) override {
    const std::lock_guard lock(mutex_);
    wanted_width_ = width;
    wanted_height_ = height;
    return picture_;
  }

 private:
  /// Copies the picture rendered so far and the counters of the last interval.
  void copy_frame() {
    const std::lock_guard lock(mutex_);
    requested_ = false;
    const std::vector<float>& rgb = front_end_->picture_so_far();
    if (wanted_width_ != 0 && wanted_height_ != 0 && rgb.size() == std::size_t{3} * width_ * height_) {
      picture_ = scale_down(rgb, width_, height_, wanted_width_, wanted_height_);
    }
    if (intervals_ == nullptr || intervals_->size() == 0) return;
    const std::size_t last = intervals_->size() - 1;
    row_.assign(intervals_->row(last).begin(), intervals_->row(last).end());
    before_.assign(row_.size(), 0);
    begin_ = 0;
    end_ = intervals_->interval_end(last);
    if (last == 0) return;
    std::ranges::copy(intervals_->row(last - 1), before_.begin());
    begin_ = intervals_->interval_end(last - 1);
  }

  double energy_until_pj(const std::vector<std::uint64_t>& row, sim::Time end) {
    sim::set_each_value(units_, [&](std::uint64_t& value, std::size_t i, sim::CounterKind) { value = row[i]; });
    formula_->set_counts(units_, end);
    return formula_->total_pj(&sim::Band::nominal);
  }

  std::atomic<bool> requested_{false};  ///< the display thread waits for a copy
  std::mutex mutex_;
  sim::EnergyConfig energy_;
  std::map<std::string, sim::DeviceEvent> device_;
  sim::PowerScales scales_;
  std::uint32_t width_ = 0, height_ = 0;  ///< size of the frame's picture in pixels
  std::vector<sim::UnitReport> units_;
  std::unique_ptr<sim::EnergyFormula> formula_;
  const FrontEnd* front_end_ = nullptr;
  const sim::Intervals* intervals_ = nullptr;
  std::size_t wanted_width_ = 0, wanted_height_ = 0;  ///< largest picture that the display thread has requested
  SmallPicture picture_;
  /// Values of all units at the start and end of the last complete interval; empty before the first.
  std::vector<std::uint64_t> before_, row_;
  sim::Time begin_ = 0, end_ = 0;
};

/// Simulates the frames. Throws Interrupted if an interrupt left fewer than `min_frames_to_replace` finished frames.
RunResult run_or_interrupt(FrameSource& frames, const RunOptions& options, std::size_t min_frames_to_replace,
                           Progress& progress) {
  const HoldInterrupts hold;  // delayed, because results exist before their folder does
  try {
    RunResult result = run(frames, options);
    if (result.partial && result.frames.size() < min_frames_to_replace) throw Interrupted();
    return result;
  } catch (const Interrupted&) {
    progress.finish("interrupted");
    throw;
  }
}

/// Returns the absolute path of --record. Throws InputError if it would replace one of the run's own results.
std::filesystem::path record_file(const JobOptions& options, const std::filesystem::path& folder) {
  const std::string asked = "--record " + sim::printable(options.record.string());
  std::error_code failed;
  std::filesystem::path file = std::filesystem::absolute(options.record, failed);
  if (!failed) file = std::filesystem::weakly_canonical(file, failed);
  if (failed) throw sim::InputError(fmt::format("{}: cannot be written ({})", asked, failed.message()));
  if (std::ranges::mismatch(file, folder).in1 == file.end())
    throw sim::InputError(asked + ": the run's folder goes there or below; allowed: another name");
  if (file.parent_path() != folder || !is_result_name(file.filename().string())) return file;
  throw sim::InputError(asked + ": the run's own results have a file of this name; allowed: another");
}

/// Which result files `raywatt run` lists on standard output.
struct ListedResults {
  bool picture, timeline, reference;
};
void print_results(const sim::Json& json, const std::filesystem::path& folder, const ListedResults& has) {
  fmt::print("{}\n", to_terminal_encoding(report_table(json)));
  if (has.picture) fmt::print("picture: {}\n", (folder / "image.png").string());
  if (has.timeline) fmt::print("timeline: {}\n", (folder / kTimelineFile).string());
  fmt::print("report:  {}\n", (folder / "report.json").string());
  if (has.reference) print_reference_location(folder);
  fmt::print("page:    raywatt report {0} -o {1}\n", command_text({folder.string()}),
             command_text({folder.string() + ".html"}));
}

}  // namespace

void run_frames(const JobOptions& options) {
  const auto begin = sim::HostClock::now();
  const RunPlan plan = make_plan(options);
  TimelineJob timeline(options.timeline);
  RunFolder folder(options.out, options.force);
  LiveRun live;
  Progress progress(options.watch ? "watch" : options.progress, options.quiet, &live);
  Inputs inputs = load_inputs(options, &progress);
  if (!options.record.empty()) refuse_sorting(inputs.config, "--record");
  const std::unique_ptr<FrameSource> source = make_frames(inputs, plan, options.threads, &progress);
  FrameSource& frames = *source;
  live.set_config(inputs.config);
  timeline.check_selection(inputs, plan.program);
  print_warnings(inputs.warnings, &progress);
  if (plan.sampling() == nullptr && plan.frame_sampling() == nullptr && progress.shows_hints()) {
    const RunParallelism parallelism{options.threads, frames.replicates(), frames.slices()};
    double frame = estimate_seconds(inputs, plan.program, parallelism);
    if (frames.has_reference()) frame += estimate_seconds(inputs, *plan.whole_frames()->reference, parallelism);
    print_duration_hint(inputs.load_seconds + frame * inputs.frames(),
                        "a smaller --resolution, fewer --frames or --tile-sampling take less", progress);
  }
  progress.expect_parts(frames.frame_count() * (frames.has_reference() ? 2 : 1) * frames.replicates());
  const std::size_t to_replace = min_frames_to_replace(folder.target() / "report.json");
  const bool has_picture = plan.sampling() == nullptr || plan.sampling()->full_image;

  RunOptions run_options{.progress = &progress,
                         .keep_part = !folder.has_earlier_run(),
                         .intervals = options.intervals,
                         .itemised = true,
                         .timeline = &timeline};
  if (options.watch) {
    run_options.observer = &live;
    run_options.on_start = [&live](const StartedFrame& frame) { live.begin_frame(frame); };
  }

  sim::Json json;
  folder.fill([&](const RunFolder::Open& open) {
    std::optional<traces::TraceWriter> trace;
    if (!options.record.empty()) {
      // If the run's folder does not exist yet, the trace is first written next to the report.
      const std::filesystem::path file = record_file(options, folder.target());
      const bool comes_along = file.parent_path() == folder.target() && !std::filesystem::exists(folder.target());
      trace.emplace(comes_along ? open() / file.filename() : std::filesystem::path(options.record),
                    trace_header(inputs, options));
    }
    run_options.trace = trace ? &*trace : nullptr;
    run_options.on_frame = [&](const SimulatedFrame& played) {
      progress.set_phase("writing the picture");
      write_pictures(
          open(),
          {.played = played, .program = plan.program, .has_picture = has_picture, .debug = options.debug_images},
          host_threads(options.threads));
    };
    const RunResult result = run_or_interrupt(frames, run_options, to_replace, progress);
    progress.finish(result.partial ? "interrupted" : "done");
    const std::filesystem::path& staging = open();
    const double wall = sim::seconds_since(begin);
    json = report_json({inputs, options, result.report_totals(), result.frames, result.partial, wall});
    timeline.write_file(staging, json);
    write_report(staging, json, inputs.config, result);
    write_reference(staging, {inputs, options}, result);
    if (trace && !result.partial) trace->commit();
    print_warnings(json, inputs.warnings.size());  // before a pending interrupt ends the process
    return result.finished_part_text(inputs.frames());
  });
  if (options.json) return fmt::print("{}", sim::json_lines(json["totals"]));
  if (options.quiet) return;
  print_results(json, folder.target(), {has_picture, timeline.tile_selection().has_value(), frames.has_reference()});
}

}  // namespace tools
