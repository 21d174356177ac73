#include "tools/run/run_result.h"

#include <utility>

#include <fmt/format.h>

#include "sim/config/config.h"
#include "sim/error.h"
#include "sim/io/file.h"
#include "sim/io/json.h"
#include "sim/report/report_json.h"
#include "tools/analysis/report_file.h"
#include "tools/host/command_text.h"
#include "tools/host/standard_streams.h"

namespace tools {
namespace {

void keep(FrameResult frame, std::optional<FrameResult>& total) {
  if (total) {
    total->add(frame);
  } else {
    total = std::move(frame);
  }
}

}  // namespace

void RunResult::add(std::uint32_t number, FrameResult frame, std::optional<FrameResult> compared, double error,
                    const sim::Intervals* over_time) {
  const auto entry_of = [&](const FrameResult& s, const Result& result) {
    sim::Json entry = {{"frame", number}};
    if (s.is_part()) entry.update({{"finished_tiles", s.finished_tiles}, {"tiles", s.tiles}});
    entry.update(totals_json(result));
    if (!s.function.sampling.similar.empty()) entry["sampling"]["tiles"] = tiles_json(s.function.sampling);
    return entry;
  };
  frames.push_back(entry_of(frame, {frame, compared ? &*compared : nullptr, error}));
  if (compared) reference_frames.push_back(entry_of(*compared, {*compared}));
  squared_error += error;
  if (over_time != nullptr) intervals.add(number, *over_time);
  keep(std::move(frame), total);
  if (compared) keep(*std::move(compared), reference);
}

Result RunResult::totals() const {
  return {*total, reference ? &*reference : nullptr, squared_error / static_cast<double>(frames.size())};
}

void RunResult::set_partial(const FrameResult& frame, std::uint32_t replicates, bool lacks_reference) {
  const bool lacks_replicates = frame.replicates.size() + 1 < replicates;
  lacks = fmt::format("{}{}{}", lacks_replicates ? "its replicates" : "",
                      lacks_replicates && lacks_reference ? " and " : "", lacks_reference ? "its reference" : "");
  partial = frame.is_part() || !lacks.empty();
}

std::string RunResult::kept(std::size_t all) const {
  if (total->is_part()) {
    return fmt::format("{} of {} tiles of frame {}", total->finished_tiles, total->tiles,
                       frames.front()["frame"].get<std::uint32_t>());
  }
  if (all > 1) return fmt::format("{} of {} frames", frames.size(), all);
  return lacks.empty() ? "the whole run" : "the run without " + lacks;
}

std::size_t frames_to_replace(const std::filesystem::path& file) {
  try {
    const auto former = sim::parse_json(sim::read_file(file, kLargestReport));
    if (!former.at("schema").get<std::string>().starts_with("raywatt-")) return 1;
    return former.at("frames").size() + (former.value("partial", false) ? 0 : 1);
  } catch (const sim::InputError&) {
  } catch (const sim::JsonError&) {
  }
  return 1;
}

void tell_warnings(const sim::Json& report, std::size_t told) {
  const sim::Json& lines = report.at("warnings");
  for (std::size_t i = told; i < lines.size(); ++i) tell("warning: {}", lines[i].get<std::string>());
}

void write_report(const std::filesystem::path& folder, const sim::Json& json, const RunConfig& config,
                  const RunResult& result) {
  sim::write_file_atomically(folder / "report.json", sim::json_text(json));
  sim::write_file_atomically(folder / "report.txt", report_table(json));
  sim::write_file_atomically(folder / "config.yaml", sim::dump_config(config));
  if (!result.intervals.empty()) {
    sim::write_file_atomically(folder / kIntervalFile, result.intervals.file(result.total->units));
  }
  if (!result.tiles.frames.empty()) sim::write_file_atomically(folder / kTilesFile, tiles_text(result.tiles));
}

void write_reference(const std::filesystem::path& folder, const Origin& origin, const RunResult& result) {
  if (!result.reference) return;
  const FrameResult& run = *result.reference;
  const double load = origin.inputs.load_seconds + origin.inputs.update_seconds;
  const double wall = load + run.wall_seconds + run.replicate_seconds;
  sim::Json json = report_json({origin.inputs, origin.options, {run}, result.reference_frames, result.partial, wall});
  // Changes the JSON because a copy of the inputs would duplicate the scene.
  RunConfig config = origin.inputs.config;
  config.render = reference_render(config.render);
  json["config"] = sim::config_json(config);
  json["provenance"]["config_hash"] = sim::config_hash(config);
  sim::write_file_atomically(folder / kReferenceReport, sim::json_text(json));
}

void tell_reference(const std::filesystem::path& folder) {
  const std::string reference = (folder / kReferenceReport).string();
  fmt::print("reference: {}\n{} says where the gain comes from\n", reference,
             command_text({"raywatt", "compare", reference, (folder / "report.json").string()}));
}

}  // namespace tools
