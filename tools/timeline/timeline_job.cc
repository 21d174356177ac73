#include "tools/timeline/timeline_job.h"

#include <utility>

#include <fmt/format.h>

#include "hw_models/machines/gpu_config.h"
#include "sim/error.h"
#include "sim/io/file.h"
#include "sim/io/json.h"

namespace tools {

TimelineJob::TimelineJob(std::string asked) : asked_(std::move(asked)) {
  if (!asked_.empty()) selection_ = parse_timeline(asked_);
}

void TimelineJob::check_selection(const Inputs& inputs, const kernels::ProgramSpec& program) const {
  if (!selection_ || !selection_->needs_places()) return;
  const bool is_tile = selection_->kind == TimelineSelection::Kind::kTile;
  kernels::TileCounts counts{inputs.config.render.width, inputs.config.render.height};
  if (is_tile) counts = tile_counts(inputs, program);
  if (selection_->x < counts.columns && selection_->y < counts.rows) return;
  const char* const what = is_tile ? "tile" : "pixel";
  throw sim::InputError(fmt::format(
      "--timeline {}: there is no such {}: the picture's {}s are {} across and {} down; allowed: 0,0 to {},{}", asked_,
      what, what, counts.columns, counts.rows, counts.columns - 1, counts.rows - 1));
}

hw::Observer* TimelineJob::begin_frame(const RunConfig& config) {
  if (!selection_ || made_) return nullptr;
  recorder_.emplace(config.gpu->cores);
  return &*recorder_;
}

void TimelineJob::end_frame(const FrameResult& s, const TileFrame& tiles, const RunConfig& config) {
  if (!recorder_) return;
  try {
    made_ = make_timeline(*recorder_, *selection_, s, tiles, config);
  } catch (const sim::InputError& error) {
    problem_ = error.what();
    selection_.reset();
  }
  recorder_.reset();
}

void TimelineJob::write_file(const std::filesystem::path& folder, sim::Json& report) const {
  if (!problem_.empty()) report["warnings"].push_back(problem_ + "; no timeline is written");
  if (!made_) return;
  sim::write_file_atomically(folder / kTimelineFile, made_->bytes);
  report["timeline"] = {{"asked", asked_}, {"slices", made_->slices}, {"dropped", made_->dropped}};
  if (made_->dropped == 0) return;
  report["warnings"].push_back(fmt::format(
      "{}: {} of {} slices are left out, as it may have {} MiB; --timeline slowest:N or tile:X,Y asks for fewer",
      kTimelineFile, made_->dropped, made_->slices + made_->dropped, kMostTimelineBytes >> 20));
}

}  // namespace tools
