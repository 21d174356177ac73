#include "tools/run/frame/run_tiles.h"

#include "hw_models/machines/gpu.h"
#include "tools/host/interrupt.h"
#include "traces/trace_file/trace_writer.h"

namespace tools {

void RunTiles::begin(const char* phase, std::uint32_t frame) const {
  if (progress_ != nullptr) progress_->begin_part(phase, frame, tiles_ + (former_ != nullptr ? former_->tiles : 0));
}

const traces::TileWork* RunTiles::next() {
  if (interrupted()) {
    if (!keep_part_ || finished_ == 0) throw Interrupted{};
    front_end_.keep_picture();
    return nullptr;
  }
  const traces::TileWork* work = front_end_.next();
  if (trace_ != nullptr && work != nullptr) trace_->add(*work);
  if (kept_ != nullptr && work != nullptr) kept_->add(*work);
  return work;
}

void RunTiles::give_back(const traces::TileWork* work) {
  front_end_.give_back(work);
  finished_ += 1;
  if (watcher_ != nullptr && watcher_->wants()) watcher_->note(front_end_.picture());
  FormerTiles all = former_ != nullptr ? *former_ : FormerTiles{};
  all.tiles += finished_;
  all.rays += front_end_.result().all_rays();
  all.cycles += gpu_ != nullptr ? gpu_->cycles_so_far() : 0;
  if (former_ != nullptr && finished_ == tiles_) {
    *former_ = all;
  } else {
    all.end(progress_);
  }
}

}  // namespace tools
