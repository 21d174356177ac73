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
#include "tools/jobs/outcome.h"
#include "tools/jobs/replay.h"
#include "tools/sampling/tile_sampling.h"
#include "tools/simulation/recorded.h"
#include "tools/studies/sweep/store/durable.h"
#include "traces/scene/images.h"
#include "traces/trace_file/trace_writer.h"

namespace tools::sweep {
namespace {

namespace fs = std::filesystem;

/// The frames of a point.
struct Frames {
  const Point& point;
  Inputs& inputs;
  std::uint32_t threads;
  traces::TraceWriter* trace;
  fs::path picture;  ///< picture of the first frame; empty: none
  Outcome out{};

  void run() {
    const kernels::ProgramSpec program = kernels::parse_program(point.program);
    kernels::RateMap rates(inputs.config.programs.multirate), reference_rates = rates;
    std::optional<TileSampling> sampling;
    if (!point.tile_sampling.empty()) {
      check_tile_sampling(program);
      sampling = parse_tile_sampling(point.tile_sampling, point.image ? "full" : "none");
    }
    for_each_frame(inputs, threads, nullptr, [&] {
      Simulation frame = sampling ? simulate_sampled(inputs, program, threads, *sampling)
                                  : simulate(inputs, program, threads,
                                             {.rates = &rates, .trace = trace, .replicates = point.replicates});
      std::optional<Simulation> compared;
      double error = 0;
      if (!point.reference.empty()) {
        compared =
            simulate(inputs, kernels::parse_program(point.reference), threads,
                     {.rates = &reference_rates, .trace = trace, .reference = true, .replicates = point.replicates});
        error = mean_squared_error(frame.function.rgb, compared->function.rgb);
      }
      if (trace != nullptr) trace->end_frame(recorded_frame(inputs.frame, error));
      if (!picture.empty() && out.frames.empty()) {
        const kernels::RenderConfig& render = inputs.config.render;
        traces::write_png(picture, render.width, render.height, to_rgb8(frame.function.rgb));
      }
      out.add(inputs.frame, std::move(frame), std::move(compared), error);
    });
  }
};

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
    if (interrupted()) throw Interrupted{};
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
    const PointKeys::Key key = keys_.key_of(point, config);
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
      tell("warning: {}; computed without it", error.what());
      store_.remove_stream(key.stream);
    }
  }
  const auto begin = sim::HostClock::now();
  const JobOptions options = point.options();
  store_.put(point.id, key.made_of, [&](const fs::path& folder) {
    Inputs& inputs = inputs_for(point, key, config);
    std::optional<Recording> recording;
    if (record && !key.stream.empty()) recording = begin_recording(key.stream, inputs, options);
    Frames frames{point, inputs, threads_, recording ? recording->trace.get() : nullptr,
                  point.image ? folder / "image.png" : fs::path()};
    frames.run();
    if (recording) recording->trace->commit();
    const Result result = frames.out.result();
    write_results(folder, report_json({inputs, options, result, frames.out.frames, false, sim::seconds_since(begin)}),
                  config);
  });
}

void PointComputer::replay(const Point& point, const PointKeys::Key& key, const RunConfig& config) {
  const auto begin = sim::HostClock::now();
  Replay job(store_.stream(key.stream), config);
  const Outcome out = job.run(threads_, {.replicates = point.replicates});
  if (out.partial) throw Interrupted{};
  const Result result = out.result();
  const sim::Json report =
      report_json({job.inputs(), point.options(), result, out.frames, false, sim::seconds_since(begin)});
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
    tell("warning: {}; points compute it each for itself", error.what());
    return std::nullopt;
  }
}

}  // namespace tools::sweep
