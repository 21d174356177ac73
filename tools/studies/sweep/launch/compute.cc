#include "tools/studies/sweep/launch/compute.h"

#include <algorithm>
#include <chrono>
#include <new>
#include <span>
#include <thread>
#include <vector>

#include <fmt/format.h>

#include "sim/config/config.h"
#include "sim/error.h"
#include "sim/host_clock.h"
#include "sim/io/json.h"
#include "sim/io/printable.h"
#include "tools/analysis/picture.h"
#include "tools/analysis/report.h"
#include "tools/host/process.h"
#include "tools/host/standard_streams.h"
#include "tools/run/frame/trace_header.h"
#include "tools/run/run.h"
#include "tools/run/stored_frames.h"
#include "tools/sampling/slices.h"
#include "traces/scene/images.h"
#include "traces/trace_file/trace_writer.h"

namespace tools::sweep {
namespace {

namespace fs = std::filesystem;
using sim::Json;

/// Simulates all frames of a point. After an interrupt it throws Interrupted instead of returning a partial result.
RunResult run_all(FrameSource& frames, const RunOptions& options) {
  RunResult result = run(frames, options);
  if (result.partial) throw Interrupted{};
  return result;
}

/// Writes the picture if the frame is the first one.
void write_picture(const SimulatedFrame& played, const fs::path& file) {
  if (!played.is_first) return;
  const kernels::RenderConfig& render = played.inputs.config.render;
  traces::write_png(file, render.width, render.height, to_rgb8(played.frame.rendered.rgb));
}

/// Throws IoError because an input of the point has changed since the sweep was planned. The caller records no Failure.
[[noreturn]] void refuse_changed(const Point& point) {
  throw sim::IoError(
      fmt::format("point {}: what it is made of has changed since the sweep was planned; the same command "
                  "plans again",
                  point.n));
}

/// Writes the report and the configuration of a point into its folder.
void write_results(const fs::path& folder, const sim::Json& report, const RunConfig& config) {
  sim::write_file_atomically(folder / "report.json", sim::json_lines(report));
  sim::write_file_atomically(folder / "config.yaml", sim::dump_config(config));
}

Failure failure_of_whole(const Point& slice, Failure failure) {
  failure.id = slice.whole;
  failure.error = fmt::format("slice {} of {}: {}", slice.slice, slice.slices, failure.error);
  return failure;
}

/// Reads the results of a slice from the store, one entry per frame.
Json frames_in(const Store& store, const Point& slice) {
  const std::optional<std::string> bytes = store.read_slice(slice.id);
  if (!bytes) {
    throw sim::IoError(fmt::format("point {}: slice {} has been taken out of the store; the same command computes it",
                                   slice.n, slice.slice));
  }
  return sim::parse_json(*bytes).at("frames");
}

/// Returns the results of frame `frame` from every slice.
std::vector<Json> frame_of_each_slice(std::span<const Json> slices, std::size_t frame) {
  std::vector<Json> out;
  for (const Json& slice : slices) out.push_back(slice.at(frame));
  return out;
}

/// Frames whose results are the joined results of their slices.
class JoinedSlices final : public PosedFrames {
 public:
  JoinedSlices(Inputs& inputs, const kernels::ProgramSpec& program, std::vector<Json> slices, std::uint32_t threads)
      : PosedFrames(inputs, threads, nullptr), program_(program), slices_(std::move(slices)) {}
  bool has_whole_frames() const override { return false; }
  bool has_reference() const override { return false; }
  FrameResult simulate(const SimulateOptions&) override {
    return join_slices(inputs_, program_,
                       frame_of_each_slice(slices_, inputs_.frame - inputs_.config.scene.first_frame));
  }
  FrameResult simulate_reference(const SimulateOptions&) override {
    throw std::logic_error("slices have no reference");
  }
  PictureError compare_pictures(const FrameResult&, const FrameResult&) override { return {}; }

 private:
  const kernels::ProgramSpec program_;
  const std::vector<Json> slices_;
};

}  // namespace

Inputs& PointComputer::inputs_for(const Point& point, const PointKeys::Key& key, const RunConfig& config) {
  const std::string wanted = inputs_text(config);
  if (wanted != inputs_key_) {
    inputs_key_.clear();
    inputs_ = {};
    inputs_ = load_inputs(config, threads_);
    if (inputs_.frames() == 1) inputs_key_ = wanted;  // a second frame would change them
  }
  inputs_.config = config;
  const auto planned = key.made_of.at("scene_sha256").get<std::string>();
  if (planned != kBuiltIn && planned != inputs_.scene_sha256) {
    inputs_key_.clear();
    refuse_changed(point);
  }
  return inputs_;
}

PointStatus PointComputer::compute_point(const Point& point, const Order& order) try {
  std::optional<sim::FileLock> lock = store_.lock_point(point.id);
  for (auto pause = std::chrono::milliseconds(2); !lock && order.wait; lock = store_.lock_point(point.id)) {
    if (is_interrupted()) throw Interrupted{};
    std::this_thread::sleep_for(pause);
    pause = std::min(pause * 2, std::chrono::milliseconds(200));
  }
  if (!lock) return PointStatus::kLocked;
  const PointStatus before = store_.status_of(point.id);
  if (before == PointStatus::kDone || (before == PointStatus::kFailed && !order.retry)) return before;
  int exit = kOurBug;
  std::string error, log;
  try {
    if (!point.error.empty()) throw sim::InputError(point.error);
    const RunConfig config = keys_.config_of(point);
    const PointKeys::Key key = keys_.key_of(point);
    if (key.id != (point.slice != 0 ? point.whole : point.id)) refuse_changed(point);
    if (const std::optional<Failure> failure = compute_missing_slices(point, order)) {
      store_.put_failure(*failure);
      return PointStatus::kFailed;
    }
    compute_now(point, key, config, order.record);
    store_.remove_failure(point.id);
    if (point.slice != 0) join_if_complete(point, order);
    return PointStatus::kComputed;
  } catch (const Interrupted&) {
    throw;
  } catch (const sim::IoError&) {
    throw;
  } catch (const std::system_error&) {
    throw;
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const sim::InputError& e) {
    exit = kBadInput;
    error = e.what();
  } catch (const sim::Deadlock& e) {
    exit = kStuckMachine;
    error = e.what();
    log = e.state;
  } catch (const std::exception& e) {
    error = fmt::format("internal error: {}", e.what());
  }
  put_failure(point, {point.id, exit, error, log, host_name(), order.attempt});
  return PointStatus::kFailed;
} catch (const std::bad_alloc&) {  // the host is short of memory; the point has no error
  throw sim::IoError(fmt::format("point {}: out of memory; fewer points at a time (-j) need less", point.n));
}

void PointComputer::compute_now(const Point& point, const PointKeys::Key& key, const RunConfig& config, bool record) {
  if (point.slice != 0) return play_slice(point, key, config);
  if (point.slices != 0) return join_slices_of(point, key, config);
  const JobOptions options = point.run_options();
  if (record && !key.stream.empty() && !point.tile_sampling.empty()) record_samples(point, key, config, options);
  if (!key.stream.empty() && fs::exists(store_.stream_file(key.stream))) {
    try {
      return replay_stream(point, key, config);
    } catch (const sim::InputError& error) {  // the trace is truncated or of other work
      print_message("warning: {}; computed without it", error.what());
      store_.remove_stream(key.stream);
    }
  }
  const auto begin = sim::HostClock::now();
  store_.put_result(point.id, key.made_of, [&](const fs::path& folder) {
    Inputs& inputs = inputs_for(point, key, config);
    std::optional<Recording> recording;
    if (record && !key.stream.empty() && point.tile_sampling.empty())
      recording = begin_recording(key.stream, inputs, options);
    const std::unique_ptr<FrameSource> frames = make_frames(inputs, make_plan(options), threads_, nullptr);
    RunOptions how{.trace = recording ? recording->trace.get() : nullptr};
    if (point.image) how.on_frame = [&](const SimulatedFrame& played) { write_picture(played, folder / "image.png"); };
    const RunResult result = run_all(*frames, how);
    if (recording) recording->trace->commit();
    write_results(
        folder, report_json({inputs, options, result.report_totals(), result.frames, false, sim::seconds_since(begin)}),
        config);
  });
}

void PointComputer::record_samples(const Point& point, const PointKeys::Key& key, const RunConfig& config,
                                   const JobOptions& options) {
  const RunPlan plan = make_plan(options);
  Inputs& inputs = inputs_for(point, key, config);
  const std::optional<Recording> recording = begin_recording(key.stream, inputs, options);
  if (!recording) return;
  for_each_frame(inputs, threads_, nullptr,
                 [&] { record_sampled_work(inputs, plan.program, threads_, *recording->trace); });
  recording->trace->commit();
}

void PointComputer::replay_stream(const Point& point, const PointKeys::Key& key, const RunConfig& config) {
  const auto begin = sim::HostClock::now();
  std::optional<TileSampling> sampling;
  if (!point.tile_sampling.empty()) sampling = parse_tile_sampling(point.tile_sampling, "none");
  StoredFrames frames(store_.stream_file(key.stream), config, threads_, point.replicates, sampling);
  const RunResult result = run_all(frames, {});
  const sim::Json report = report_json(
      {frames.inputs(), point.run_options(), result.report_totals(), result.frames, false, sim::seconds_since(begin)});
  store_.put_result(point.id, key.made_of, [&](const fs::path& folder) { write_results(folder, report, config); });
}

std::optional<PointComputer::Recording> PointComputer::begin_recording(const std::string& stream, const Inputs& inputs,
                                                                       const JobOptions& options) {
  std::optional<sim::FileLock> lock = store_.lock_stream(stream);
  if (!lock) return std::nullopt;  // another process records it
  try {
    auto trace = std::make_unique<traces::TraceWriter>(store_.stream_file(stream), trace_header(inputs, options));
    return Recording{*std::move(lock), std::move(trace)};
  } catch (const sim::InputError& error) {
    print_message("warning: {}; points compute it each for itself", error.what());
    return std::nullopt;
  }
}

void PointComputer::play_slice(const Point& slice, const PointKeys::Key& key, const RunConfig& config) {
  const kernels::ProgramSpec program = kernels::parse_program(slice.program);
  store_.put_result(slice.id, slice_identity(slice), [&](const fs::path& folder) {
    Inputs& inputs = inputs_for(slice, key, config);
    Json frames = Json::array();
    for_each_frame(inputs, threads_, nullptr,
                   [&] { frames.push_back(simulate_slice(inputs, program, threads_, slice.slices, slice.slice - 1)); });
    sim::write_file_atomically(folder / kSliceFile,
                               sim::json_line(Json{{"schema", "raywatt-slice/1"}, {"frames", frames}}) + "\n");
  });
}

void PointComputer::join_slices_of(const Point& whole, const PointKeys::Key& key, const RunConfig& config) {
  const kernels::ProgramSpec program = kernels::parse_program(whole.program);
  store_.put_result(whole.id, key.made_of, [&](const fs::path& folder) {
    Inputs& inputs = inputs_for(whole, key, config);
    RunResult result;
    try {
      std::vector<Json> slices;
      for (const Point& slice : slices_of(whole)) slices.push_back(frames_in(store_, slice));
      JoinedSlices frames(inputs, program, std::move(slices), threads_);
      result = run(frames, {});
    } catch (const sim::JsonError& error) {
      throw sim::InputError(fmt::format("a slice in the store is damaged: {}", sim::printable(error.what())));
    }
    if (result.partial) throw Interrupted{};
    const double wall = result.total->wall_seconds + inputs.load_seconds + inputs.update_seconds;
    write_results(
        folder, report_json({inputs, whole.run_options(), result.report_totals(), result.frames, false, wall}), config);
  });
}

std::optional<Failure> PointComputer::compute_missing_slices(const Point& whole, const Order& order) {
  std::vector<Point> missing;
  for (const Point& slice : slices_of(whole)) {
    if (store_.is_done(slice.id)) continue;
    if (const auto failure = store_.read_failure(slice.id)) return failure_of_whole(slice, *failure);
    missing.push_back(slice);
  }
  for (const Point& slice : missing) {
    if (compute_point(slice, {.wait = true, .attempt = order.attempt}) != PointStatus::kFailed) continue;
    return failure_of_whole(slice, store_.read_failure(slice.id).value_or(Failure()));
  }
  return std::nullopt;
}

void PointComputer::join_if_complete(const Point& slice, const Order& order) {
  const Point whole = whole_point_of(slice);
  const auto is_there = [&](const Point& one) { return fs::exists(store_.folder_of(one.id)); };
  if (std::ranges::all_of(slices_of(whole), is_there))
    compute_point(whole, {.retry = order.retry, .attempt = order.attempt});
}

void PointComputer::put_failure(const Point& point, const Failure& failure) const {
  store_.put_failure(failure);
  if (point.slice == 0) return;
  // If another process holds the lock, that process will find the failure of the slice.
  const std::optional<sim::FileLock> lock = store_.lock_point(point.whole);
  if (lock && store_.status_of(point.whole) == PointStatus::kMissing) {
    store_.put_failure(failure_of_whole(point, failure));
  }
}

}  // namespace tools::sweep
