#include "tools/run/run.h"

#include <algorithm>
#include <array>
#include <utility>

#include <fmt/format.h>

#include "hw_models/memory/observer.h"
#include "sim/config/config.h"
#include "sim/error.h"
#include "sim/io/file.h"
#include "sim/io/json.h"
#include "tools/analysis/picture.h"
#include "tools/analysis/report.h"
#include "tools/analysis/report_file.h"
#include "tools/host/process.h"
#include "tools/host/standard_streams.h"
#include "tools/run/frame/trace_header.h"
#include "tools/run/representative_frames.h"
#include "tools/sampling/slices.h"
#include "tools/tiles/denoise_cost.h"
#include "tools/tiles/tile_energy.h"
#include "traces/trace_file/trace_writer.h"

namespace tools {

RenderedFrames::RenderedFrames(Inputs& inputs, const RunPlan& plan, std::uint32_t threads, Progress* progress)
    : PosedFrames(inputs, threads, progress),
      plan_(plan),
      slices_(plan.slice_settings() != nullptr ? slice_count(inputs.config, plan.program, plan.slice_settings()->slices)
                                               : 0),
      rates_(inputs.config.programs.multirate),
      reference_rates_(rates_) {}

bool RenderedFrames::has_whole_frames() const { return plan_.sampling() == nullptr && slices_ <= 1; }

FrameResult RenderedFrames::simulate(const SimulateOptions& extras) {
  if (plan_.sampling() != nullptr)
    return simulate_sampled(inputs_, plan_.program, threads_, *plan_.sampling(), progress_);
  if (slices_ > 1) return simulate_slices(inputs_, plan_.program, threads_, slices_, progress_);
  SimulateOptions own = extras;
  own.rates = &rates_;
  own.history = &history_;
  own.marks = plan_.whole_frames() != nullptr && plan_.whole_frames()->debug_images;
  // The frame before a representative frame is not simulated.
  if (plan_.frame_sampling() == nullptr) own.caches = std::exchange(caches_, nullptr);
  FrameResult frame = simulate_frame(inputs_, plan_.program, threads_, own);
  caches_ = std::exchange(frame.caches, nullptr);
  if (slices_ == 1) frame.sliced = to_single_slice(frame);
  return frame;
}

FrameResult RenderedFrames::simulate_reference(const SimulateOptions& extras) {
  SimulateOptions own = extras;
  own.rates = &reference_rates_;
  own.reference = true;
  own.caches = std::exchange(reference_caches_, nullptr);
  FrameResult frame = simulate_frame(inputs_, *plan_.whole_frames()->reference, threads_, own);
  reference_caches_ = std::exchange(frame.caches, nullptr);
  return frame;
}

PictureError RenderedFrames::compare_pictures(const FrameResult& frame, const FrameResult& reference) {
  return pictures_.compare_frame(frame.rendered.rgb, reference.rendered.rgb, perceived_width(inputs_.config));
}

namespace {

/// Simulates the current frame and its reference, and adds their results to `out`.
void simulate_frame_with_reference(FrameSource& frames, const RunOptions& options, RunResult& out) {
  const Inputs& inputs = frames.inputs();
  const bool may_be_part = options.keep_part && out.frames.empty() && frames.has_whole_frames();
  std::optional<sim::Intervals> intervals;
  if ((options.intervals || options.on_start) && frames.has_whole_frames()) {
    intervals = intervals_of_frame(frames.frame_count());
  }
  const SimulateOptions common{.progress = options.progress, .trace = options.trace, .replicates = frames.replicates()};
  SimulateOptions own = common;
  own.keep_part = may_be_part;
  own.intervals = intervals ? &*intervals : nullptr;
  own.on_start = options.on_start;
  own.itemised = options.itemised || inputs.config.programs.denoise.has_kernels();  // for its costs
  hw::ObserverList observers;
  if (frames.has_whole_frames()) {
    observers.add(options.observer);
    if (options.timeline != nullptr) observers.add(options.timeline->begin_frame(inputs.config));
  }
  own.observer = observers.attached_observer();
  FrameResult frame = frames.simulate(own);
  frame.denoise = denoise_cost(frame, inputs.config);
  const bool has_tiles = !frame.tile_accounts.empty();
  if (has_tiles) {
    out.tiles.frames.push_back(compute_tile_table(frame, inputs.config, inputs.frame));
    if (options.timeline != nullptr) options.timeline->end_frame(frame, out.tiles.frames.back(), inputs.config);
  }
  std::optional<FrameResult> reference;
  if (frames.has_reference() && !frame.is_partial()) {
    try {
      SimulateOptions of_reference = common;
      of_reference.itemised = options.itemised;
      reference = frames.simulate_reference(of_reference);
      if (!reference->tile_accounts.empty())
        out.reference_tiles.frames.push_back(compute_tile_table(*reference, inputs.config, inputs.frame));
    } catch (const Interrupted&) {
      if (!may_be_part) throw;
    }
  }
  out.set_missing_parts(frame, frames.replicates(), frames.has_reference() && !reference);
  const PictureError error = reference ? frames.compare_pictures(frame, *reference) : PictureError{};
  if (options.trace != nullptr && !out.partial)
    options.trace->end_frame(recorded_frame(inputs.frame, recorded_error(error)));
  if (options.on_frame) {
    options.on_frame({.inputs = inputs,
                      .frame = frame,
                      .reference = reference ? &*reference : nullptr,
                      .tiles = has_tiles ? &out.tiles.frames.back() : nullptr,
                      .is_first = out.frames.empty()});
  }
  out.add(inputs.frame, std::move(frame), std::move(reference), error,
          options.intervals && intervals ? &*intervals : nullptr);
}

}  // namespace

RunResult run(FrameSource& frames, const RunOptions& options) {
  RunResult out;
  try {
    do {
      simulate_frame_with_reference(frames, options, out);
    } while (!out.partial && frames.advance_frame());
  } catch (const Interrupted&) {
    if (out.frames.empty()) throw;
    out.partial = true;
  }
  frames.complete_result(out);
  return out;
}

std::unique_ptr<FrameSource> make_frames(Inputs& inputs, const RunPlan& plan, std::uint32_t threads,
                                         Progress* progress) {
  if (plan.frame_sampling() != nullptr) {
    return std::make_unique<RepresentativeFrames>(inputs, plan, threads, progress);
  }
  return std::make_unique<RenderedFrames>(inputs, plan, threads, progress);
}

sim::Json plain_report(Inputs inputs, const JobOptions& options, Progress* progress) {
  const std::unique_ptr<FrameSource> frames = make_frames(inputs, make_plan(options), options.threads, progress);
  const RunResult result = run(*frames, {.progress = progress});
  if (result.partial) throw Interrupted();
  return report_json({inputs, options, result.report_totals(), result.frames, false, 0});
}

namespace {

/// An option that requires whole frames, and the reasons why it cannot be combined with sampling or with slices.
struct WholeFrameOption {
  const char* option;
  bool (*is_given)(const JobOptions& options);
  const char* why_not_sampled;
  const char* why_not_sliced;
  const char* why_not_represented;
};
constexpr std::array<WholeFrameOption, 5> kWholeFrameOptions = {{
    {"--reference", [](const JobOptions& o) { return !o.reference.empty(); }, "compare two runs of all tiles",
     "compare two runs with equal --slices", "compare two runs of the same frames"},
    {"--replicates", [](const JobOptions& o) { return o.replicates > 1; }, "replicates play all tiles",
     "replicates are played side by side already", "the variation within clusters includes the noise of frames"},
    {"--timeline", [](const JobOptions& o) { return !o.timeline.empty(); },
     "a timeline is of a frame whose tiles are all timed", "a timeline is of one machine",
     "a timeline is of the first frame"},
    {"--record", [](const JobOptions& o) { return !o.record.empty(); }, "a trace has all tiles",
     "slices render tiles at their borders twice", "a trace has consecutive frames"},
    {"--debug-images", [](const JobOptions& o) { return o.debug_images; }, "they show what all tiles took",
     "what a tile took is that of one machine", "they show a sequence of frames"},
}};

void refuse_options_of_whole_frames(const JobOptions& options, const char* mode, const char* WholeFrameOption::*why) {
  for (const WholeFrameOption& each : kWholeFrameOptions) {
    if (each.is_given(options))
      throw sim::InputError(fmt::format("{} does not go with {}: {}", mode, each.option, each.*why));
  }
}

}  // namespace

RunPlan make_plan(const JobOptions& options) {
  RunPlan plan{kernels::parse_program(options.program), WholeFrames{}};
  const bool is_sampled = !options.tile_sampling.empty(), is_sliced = !options.slices.empty();
  const bool is_represented = !options.representative.empty();
  if (is_sampled) {
    check_tile_sampling(plan.program);
    refuse_options_of_whole_frames(options, "--tile-sampling", &WholeFrameOption::why_not_sampled);
    plan.how = parse_tile_sampling(options.tile_sampling, options.image);
  } else if (options.image != "full") {
    throw sim::InputError("--image none goes with --tile-sampling only");
  }
  if (is_sliced) {
    const std::uint32_t slices = parse_slices(options.slices);
    check_slices(plan.program);
    if (is_sampled) {
      throw sim::InputError("--slices does not go with --tile-sampling: a sample of the tiles is not cut");
    }
    if (is_represented) throw sim::InputError("--slices does not go with --representative; allowed: one of the two");
    refuse_options_of_whole_frames(options, "--slices", &WholeFrameOption::why_not_sliced);
    plan.how = SlicedFrames{slices};
  }
  if (is_represented) {
    check_representative(plan.program);
    refuse_options_of_whole_frames(options, "--representative", &WholeFrameOption::why_not_represented);
    FrameSampling frames = parse_representative(options.representative);
    if (is_sampled) frames.tiles = *plan.sampling();
    plan.how = frames;
  }
  if (!is_sampled && !is_sliced && !is_represented) {
    WholeFrames whole{{}, options.replicates, options.debug_images};
    if (!options.reference.empty()) whole.reference = kernels::parse_program(options.reference);
    plan.how = whole;
  }
  return plan;
}

namespace {

void add_to_sum(FrameResult frame, std::optional<FrameResult>& total) {
  if (total) {
    total->add(frame);
  } else {
    total = std::move(frame);
  }
}

}  // namespace

void RunResult::add(std::uint32_t number, FrameResult frame, std::optional<FrameResult> compared,
                    const PictureError& error, const sim::Intervals* over_time) {
  const auto entry_of = [&](const FrameResult& s, const ComparedResult& result) {
    sim::Json entry = {{"frame", number}};
    if (s.is_partial()) entry.update({{"finished_tiles", s.finished_tiles}, {"tiles", s.tiles}});
    entry.update(totals_json(result));
    if (s.tree) {
      entry["tree"] = {
          {"refitted", s.tree->refitted}, {"sah_cost", s.tree->sah_cost}, {"sah_growth", s.tree->sah_growth}};
    }
    if (!s.rendered.sampling.similar.empty()) entry["sampling"]["tiles"] = tiles_json(s.rendered.sampling);
    return entry;
  };
  frames.push_back(entry_of(frame, {frame, compared ? &*compared : nullptr, error}));
  if (compared) reference_frames.push_back(entry_of(*compared, {*compared}));
  squared_error += error.squared;
  perceived.add(error.perceived);
  worst_squared_error = std::max(worst_squared_error, error.squared);
  if (error.change) worst_change = std::max(worst_change.value_or(0), *error.change);
  if (over_time != nullptr) intervals.add(number, *over_time);
  add_to_sum(std::move(frame), total);
  if (compared) add_to_sum(*std::move(compared), reference);
}

ComparedResult RunResult::report_totals() const {
  ComparedResult totals{*total,
                        reference ? &*reference : nullptr,
                        {squared_error / static_cast<double>(frames.size()), worst_change, perceived}};
  if (worst_change) totals.worst_squared_error = worst_squared_error;
  return totals;
}

void RunResult::set_missing_parts(const FrameResult& frame, std::uint32_t replicates, bool lacks_reference) {
  const bool lacks_replicates = frame.replicates.size() + 1 < replicates;
  missing = fmt::format("{}{}{}", lacks_replicates ? "its replicates" : "",
                        lacks_replicates && lacks_reference ? " and " : "", lacks_reference ? "its reference" : "");
  partial = frame.is_partial() || !missing.empty();
}

std::uint32_t perceived_width(const RunConfig& config) {
  return config.programs.denoise.filter != kernels::DenoiseFilter::kOff ? config.render.width : 0;
}

RecordedError recorded_error(const PictureError& error) {
  RecordedError recorded{error.squared, error.change, {}, {}};
  if (error.perceived.frames != 0) recorded.flip = error.perceived.flip;
  if (error.perceived.changes != 0) recorded.flicker = error.perceived.flicker;
  return recorded;
}

std::string RunResult::finished_part_text(std::size_t all) const {
  if (total->is_partial()) {
    return fmt::format("{} of {} tiles of frame {}", total->finished_tiles, total->tiles,
                       frames.front()["frame"].get<std::uint32_t>());
  }
  if (all > 1) return fmt::format("{} of {} frames", frames.size(), all);
  return missing.empty() ? "the whole run" : "the run without " + missing;
}

std::size_t min_frames_to_replace(const std::filesystem::path& file) {
  try {
    const auto former = sim::parse_json(sim::read_file(file, kLargestReport));
    if (!former.at("schema").get<std::string>().starts_with("raywatt-")) return 1;
    return former.at("frames").size() + (former.value("partial", false) ? 0 : 1);
  } catch (const sim::InputError&) {
  } catch (const sim::JsonError&) {
  }
  return 1;
}

void print_warnings(const sim::Json& report, std::size_t already_printed) {
  const sim::Json& lines = report.at("warnings");
  for (std::size_t i = already_printed; i < lines.size(); ++i)
    print_message("warning: {}", lines[i].get<std::string>());
}

void write_report(const std::filesystem::path& folder, const sim::Json& json, const RunConfig& config,
                  const RunResult& result) {
  sim::write_file_atomically(folder / "report.json", sim::json_lines(json));
  sim::write_file_atomically(folder / "report.txt", report_table(json));
  sim::write_file_atomically(folder / "config.yaml", sim::dump_config(config));
  if (!result.intervals.empty()) {
    sim::write_file_atomically(folder / kIntervalFile, result.intervals.file_bytes(result.total->units));
  }
  if (!result.tiles.frames.empty()) sim::write_file_atomically(folder / kTilesFile, tiles_text(result.tiles));
}

void write_reference(const std::filesystem::path& folder, const Origin& origin, const RunResult& result) {
  if (!result.reference) return;
  const FrameResult& run = *result.reference;
  const double load = origin.inputs.load_seconds + origin.inputs.update_seconds;
  const double wall = load + run.wall_seconds + run.replicate_seconds;
  sim::Json json = report_json({origin.inputs, origin.options, {run}, result.reference_frames, result.partial, wall});
  // Changes the report's JSON, because a changed copy of the inputs would duplicate the scene.
  RunConfig config = origin.inputs.config;
  config.render = reference_render(config.render);
  config.programs = reference_programs(config.programs);
  json["config"] = sim::config_json(config);
  json["provenance"]["config_hash"] = sim::config_hash(config);
  sim::write_file_atomically(folder / kReferenceReport, sim::json_lines(json));
  if (!result.reference_tiles.frames.empty())
    sim::write_file_atomically(folder / kReferenceTiles, tiles_text(result.reference_tiles));
}

void print_reference_location(const std::filesystem::path& folder) {
  const std::string reference = (folder / kReferenceReport).string();
  fmt::print("reference: {}\ncompare with: {}\n", reference,
             command_text({"raywatt", "compare", reference, (folder / "report.json").string()}));
}

}  // namespace tools
