#include <algorithm>
#include <span>
#include <vector>

#include <fmt/format.h>

#include "sim/error.h"
#include "sim/io/json.h"
#include "sim/io/printable.h"
#include "tools/analysis/report.h"
#include "tools/host/interrupt.h"
#include "tools/run/run.h"
#include "tools/sampling/slices.h"
#include "tools/studies/sweep/launch/compute.h"
#include "tools/studies/sweep/store/durable.h"

namespace tools::sweep {
namespace {

namespace fs = std::filesystem;
using sim::Json;

Failure failure_of_whole(const Point& slice, Failure failure) {
  failure.id = slice.whole;
  failure.error = fmt::format("slice {} of {}: {}", slice.slice, slice.slices, failure.error);
  return failure;
}

/// Frames of a slice, as they were put into the store.
Json frames_in(const Store& store, const Point& slice) {
  const std::optional<std::string> bytes = store.slice(slice.id);
  if (!bytes) {
    throw sim::IoError(fmt::format("point {}: slice {} has been taken out of the store; the same command computes it",
                                   slice.n, slice.slice));
  }
  return sim::parse_json(*bytes).at("frames");
}

/// One frame's of all slices.
std::vector<Json> at_frame(std::span<const Json> slices, std::size_t frame) {
  std::vector<Json> out;
  for (const Json& slice : slices) out.push_back(slice.at(frame));
  return out;
}

/// Frames that are added up from the results of their slices.
class JoinedSlices final : public PosedFrames {
 public:
  /// `slices`: the frames of each slice.
  JoinedSlices(Inputs& inputs, const kernels::ProgramSpec& program, std::vector<Json> slices, std::uint32_t threads)
      : PosedFrames(inputs, threads, nullptr), program_(program), slices_(std::move(slices)) {}
  bool has_whole_frames() const override { return false; }
  bool has_reference() const override { return false; }
  FrameResult simulate(const SimulateOptions&) override {
    return join_slices(inputs_, program_, at_frame(slices_, inputs_.frame - inputs_.config.scene.first_frame));
  }
  FrameResult simulate_reference(const SimulateOptions&) override {
    throw std::logic_error("slices have no reference");
  }
  double squared_error(const FrameResult&, const FrameResult&) const override { return 0; }

 private:
  const kernels::ProgramSpec program_;
  const std::vector<Json> slices_;
};

}  // namespace

void PointComputer::play_slice(const Point& slice, const PointKeys::Key& key, const RunConfig& config) {
  const kernels::ProgramSpec program = kernels::parse_program(slice.program);
  store_.put(slice.id, made_of(slice), [&](const fs::path& folder) {
    Inputs& inputs = inputs_for(slice, key, config);
    Json frames = Json::array();
    for_each_frame(inputs, threads_, nullptr,
                   [&] { frames.push_back(simulate_slice(inputs, program, threads_, slice.slices, slice.slice - 1)); });
    write_durably(folder / kSliceFile, sim::json_line(Json{{"schema", "raywatt-slice/1"}, {"frames", frames}}) + "\n");
  });
}

void PointComputer::join(const Point& whole, const PointKeys::Key& key, const RunConfig& config) {
  const kernels::ProgramSpec program = kernels::parse_program(whole.program);
  store_.put(whole.id, key.made_of, [&](const fs::path& folder) {
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
    write_results(folder, report_json({inputs, whole.options(), result.report_totals(), result.frames, false, wall}),
                  config);
  });
}

std::optional<Failure> PointComputer::complete(const Point& whole, const Order& order) {
  std::vector<Point> missing;
  for (const Point& slice : slices_of(whole)) {
    if (store_.state(slice.id) == Store::State::kGood) continue;
    if (const auto failure = store_.failure(slice.id)) return failure_of_whole(slice, *failure);
    missing.push_back(slice);
  }
  for (const Point& slice : missing) {
    if (compute(slice, {.wait = true, .attempt = order.attempt}) != Fate::kFailed) continue;
    return failure_of_whole(slice, store_.failure(slice.id).value_or(Failure()));
  }
  return std::nullopt;
}

void PointComputer::join_after(const Point& slice, const Order& order) {
  const Point whole = whole_of(slice);
  const auto is_there = [&](const Point& one) { return fs::exists(store_.folder(one.id)); };
  if (std::ranges::all_of(slices_of(whole), is_there)) compute(whole, {.retry = order.retry, .attempt = order.attempt});
}

void PointComputer::put_failure(const Point& point, const Failure& failure) const {
  store_.put_failure(failure);
  if (point.slice == 0) return;
  const std::optional<Lock> lock = store_.lock(point.whole);  // who holds it finds the slice's
  if (lock && store_.state(point.whole) != Store::State::kGood && !store_.failure(point.whole)) {
    store_.put_failure(failure_of_whole(point, failure));
  }
}

}  // namespace tools::sweep
