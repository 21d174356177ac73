#include "tools/sampling/sampled_tiles.h"

#include <algorithm>

#include "sim/host_clock.h"

namespace tools {

const traces::TileWork* SampledTiles::next() {
  while (block_ < blocks_.size()) {
    const TimedBlock& block = blocks_[block_];
    const traces::TileWork* work = source_.next();
    if (work == nullptr) return nullptr;
    if (work->tile >= block.first) {
      if (work->tile + 1 == block.end) block_ += 1;
      waiting_.push_back(work->tile);
      return work;
    }
    if (work->tile + block.warming >= block.first) {
      for_warming_.push_back(work);
    } else {
      source_.give_back(work);
    }
  }
  while (const traces::TileWork* work = source_.next()) source_.give_back(work);
  return nullptr;
}

void SampledTiles::give_back(const traces::TileWork* work) {
  back_.push_back(work->tile);
  source_.give_back(work);
}

void SampledTiles::dispatched(sim::Time now) {
  const std::uint32_t tile = waiting_.back();
  waiting_.pop_back();
  for (const std::uint32_t ended : back_) {
    std::ranges::find(played_.rbegin(), played_.rend(), ended, &Played::tile)->end = now;
  }
  back_.clear();
  if (tile >= blocks_[dispatched_block_].end) dispatched_block_ += 1;
  const TimedBlock& block = blocks_[dispatched_block_];
  if (tile == block.first) {
    if (dispatched_block_ != 0) mark(now);
    warm();
  }
  if (tile == block.measured) mark(now);
  played_.push_back({tile, now, now});
}

void SampledTiles::mark(sim::Time now) {
  gpu_->bring_up_to(now);
  marks_.push_back({now, gpu_->report(), gpu_->kernel_use()});
}

void SampledTiles::warm() {
  const sim::HostClock::time_point begin = sim::HostClock::now();
  std::uint32_t core = 0;
  for (const traces::TileWork* work : for_warming_) {
    gpu_->warm(*work, core);
    core = core + 1 == gpu_->cores() ? 0 : core + 1;
    source_.give_back(work);
  }
  warmed_ += for_warming_.size();
  for_warming_.clear();
  warming_seconds_ += sim::seconds_since(begin);
}

void SampledTiles::finish() {
  for (Played& tile : played_) {
    if (tile.end == tile.begin) tile.end = gpu_->elapsed();
  }
  mark(gpu_->elapsed());
}

}  // namespace tools
