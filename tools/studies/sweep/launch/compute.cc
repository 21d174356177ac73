#include "tools/studies/sweep/launch/compute.h"

#include <algorithm>
#include <chrono>
#include <new>
#include <thread>

#include <fmt/format.h>

#include "sim/config/config.h"
#include "sim/error.h"
#include "sim/host_clock.h"
#include "sim/report/report_json.h"
#include "tools/analysis/picture.h"
#include "tools/host/exit_code.h"
#include "tools/host/interrupt.h"
#include "tools/host/standard_streams.h"
#include "tools/run/frame/trace_header.h"
#include "tools/run/stored_frames.h"
#include "tools/studies/sweep/store/durable.h"
#include "traces/scene/images.h"
#include "traces/trace_file/trace_writer.h"

namespace tools::sweep {
namespace {

namespace fs = std::filesystem;

/// run() of frames that are no part of a result unless all are there.
RunResult run_all(FrameSource& frames, const RunOptions& options) {
  RunResult result = run(frames, options);
  if (result.partial) throw Interrupted{};
  return result;
}

/// Writes the picture of the first frame.
void write_picture(const PlayedFrame& played, const fs::path& file) {
  if (!played.is_first) return;
  const kernels::RenderConfig& render = played.inputs.config.render;
  traces::write_png(file, render.width, render.height, to_rgb8(played.frame.rendered.rgb));
}

}  // namespace

void refuse_changed(const Point& point) {
  throw sim::IoError(
      fmt::format("point {}: what it is made of has changed since the sweep was planned; the same command "
                  "plans anew",
                  point.n));
}

void write_results(const fs::path& folder, const sim::Json& report, const RunConfig& config) {
  write_durably(folder / "report.json", sim::json_text(report));
  write_durably(folder / "config.yaml", sim::dump_config(config));
}

Inputs& PointComputer::inputs_for(const Point& point, const PointKeys::Key& key, const RunConfig& config) {
  const std::string wanted = inputs_key(config);
  if (wanted != inputs_key_) {
    inputs_key_.clear();
    inputs_ = {};
    inputs_ = load_inputs(config, threads_);
    if (inputs_.frames() == 1) inputs_key_ = wanted;  // later frames change them
  }
  inputs_.config = config;
  const auto planned = key.made_of.at("scene_sha256").get<std::string>();
  if (planned != kBuiltIn && planned != inputs_.scene_sha256) {
    inputs_key_.clear();
    refuse_changed(point);
  }
  return inputs_;
}

Fate PointComputer::compute(const Point& point, const Order& order) try {
  std::optional<Lock> lock = store_.lock(point.id);
  for (auto pause = std::chrono::milliseconds(2); !lock && order.wait; lock = store_.lock(point.id)) {
    if (is_interrupted()) throw Interrupted{};
    std::this_thread::sleep_for(pause);
    pause = std::min(pause * 2, std::chrono::milliseconds(200));
  }
  if (!lock) return Fate::kLocked;
  if (store_.state(point.id) == Store::State::kGood) return Fate::kFound;
  if (!order.retry && store_.failure(point.id)) return Fate::kFailed;
  int exit = kOurBug;
  std::string error, log;
  try {
    if (!point.error.empty()) throw sim::InputError(point.error);
    const RunConfig config = keys_.config_of(point);
    const PointKeys::Key key = keys_.key_of(point);
    if (key.id != (point.slice != 0 ? point.whole : point.id)) refuse_changed(point);
    if (const std::optional<Failure> failure = complete(point, order)) {
      store_.put_failure(*failure);
      return Fate::kFailed;
    }
    compute_now(point, key, config, order.record);
    store_.forget_failure(point.id);
    if (point.slice != 0) join_after(point, order);
    return Fate::kComputed;
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
  return Fate::kFailed;
} catch (const std::bad_alloc&) {  // the host is short of it now, the point is not to blame
  throw sim::IoError(fmt::format("point {}: out of memory; fewer points at a time (-j) need less", point.n));
}

void PointComputer::compute_now(const Point& point, const PointKeys::Key& key, const RunConfig& config, bool record) {
  if (point.slice != 0) return play_slice(point, key, config);
  if (point.slices != 0) return join(point, key, config);
  if (!key.stream.empty() && fs::exists(store_.stream(key.stream))) {
    try {
      return replay(point, key, config);
    } catch (const sim::InputError& error) {  // cut short, or of another hand
      print_message("warning: {}; computed without it", error.what());
      store_.remove_stream(key.stream);
    }
  }
  const auto begin = sim::HostClock::now();
  const JobOptions options = point.options();
  store_.put(point.id, key.made_of, [&](const fs::path& folder) {
    Inputs& inputs = inputs_for(point, key, config);
    std::optional<Recording> recording;
    if (record && !key.stream.empty()) recording = begin_recording(key.stream, inputs, options);
    RenderedFrames frames(inputs, make_plan(options), threads_, nullptr);
    RunOptions how{.trace = recording ? recording->trace.get() : nullptr};
    if (point.image) how.on_frame = [&](const PlayedFrame& played) { write_picture(played, folder / "image.png"); };
    const RunResult result = run_all(frames, how);
    if (recording) recording->trace->commit();
    write_results(
        folder, report_json({inputs, options, result.report_totals(), result.frames, false, sim::seconds_since(begin)}),
        config);
  });
}

void PointComputer::replay(const Point& point, const PointKeys::Key& key, const RunConfig& config) {
  const auto begin = sim::HostClock::now();
  StoredFrames frames(store_.stream(key.stream), config, threads_, point.replicates);
  const RunResult result = run_all(frames, {});
  const sim::Json report = report_json(
      {frames.inputs(), point.options(), result.report_totals(), result.frames, false, sim::seconds_since(begin)});
  store_.put(point.id, key.made_of, [&](const fs::path& folder) { write_results(folder, report, config); });
}

std::optional<PointComputer::Recording> PointComputer::begin_recording(const std::string& stream, const Inputs& inputs,
                                                                       const JobOptions& options) {
  std::optional<Lock> lock = store_.lock_stream(stream);
  if (!lock) return std::nullopt;  // another process records it
  try {
    auto trace = std::make_unique<traces::TraceWriter>(store_.stream(stream), trace_header(inputs, options));
    return Recording{*std::move(lock), std::move(trace)};
  } catch (const sim::InputError& error) {  // not every kind of work can be recorded
    print_message("warning: {}; points compute it each for itself", error.what());
    return std::nullopt;
  }
}

}  // namespace tools::sweep
