#include "tools/sampling/slice_tiles.h"

#include <algorithm>

#include "sim/host_clock.h"

namespace tools {

SliceTiles::SliceTiles(hw::TileSource& source, const Slice& slice, std::uint32_t probe, bool is_last)
    : source_(source), slice_(slice), next_(slice.begin()), dispatched_(slice.lead_begin()) {
  if (slice.first != 0) to_mark_ = {slice.first - probe, slice.first};
  if (!is_last) to_mark_.insert(to_mark_.end(), {slice.end - probe, slice.end});
}

const traces::TileWork* SliceTiles::next() {
  for (; next_ < slice_.lead_begin(); ++next_) for_warming_.push_back(take());
  if (next_ > slice_.end) return nullptr;
  next_ += 1;
  return take();
}

const traces::TileWork* SliceTiles::take() {
  const double begin = sim::thread_seconds();
  const traces::TileWork* work = source_.next();
  making_seconds_ += sim::thread_seconds() - begin;
  return work;
}

void SliceTiles::dispatched(sim::Time now) {
  const std::uint32_t tile = dispatched_++;
  if (tile == slice_.lead_begin()) warm();
  if (std::ranges::find(to_mark_, tile) == to_mark_.end()) return;
  gpu_->bring_up_to(now);
  marks_.push_back({tile, now, gpu_->report(), gpu_->kernel_use()});
  if (tile == slice_.end) gpu_->stop();
}

const SliceTiles::Mark& SliceTiles::at(std::uint32_t tile) const {
  return *std::ranges::find(marks_, tile, &Mark::tile);
}

void SliceTiles::warm() {
  std::uint32_t core = 0;
  for (const traces::TileWork* work : for_warming_) {
    gpu_->warm(*work, core);
    core = core + 1 == gpu_->cores() ? 0 : core + 1;
    source_.give_back(work);
  }
  for_warming_.clear();
}

}  // namespace tools
