#include "tools/timeline/timeline_job.h"

#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "sim/error.h"
#include "sim/io/file.h"

namespace tools {

TimelineJob::TimelineJob(std::string asked) : asked_(std::move(asked)) {
  if (!asked_.empty()) selection_ = parse_timeline(asked_);
}

void TimelineJob::check_pixel(std::uint32_t width, std::uint32_t height) const {
  if (!selection_ || selection_->kind != TimelineSelection::Kind::kPixel) return;
  if (selection_->x < width && selection_->y < height) return;
  throw sim::InputError(
      fmt::format("--timeline {}: there is no such pixel; allowed: 0,0 to {},{}", asked_, width - 1, height - 1));
}

hw::Watchers TimelineJob::begin_frame(const RunConfig& config) {
  if (!selection_ || made_) return {};
  recorder_.emplace(config.gpu.cores);
  return recorder_->watchers();
}

void TimelineJob::end_frame(const Simulation& s, const TileFrame& tiles, const RunConfig& config) {
  if (!recorder_) return;
  try {
    made_ = make_timeline(*recorder_, *selection_, s, tiles, config);
  } catch (const sim::InputError& error) {
    problem_ = error.what();
    selection_.reset();
  }
  recorder_.reset();
}

void TimelineJob::write(const std::filesystem::path& folder, nlohmann::ordered_json& report) const {
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
