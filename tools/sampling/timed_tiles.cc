#include "tools/sampling/timed_tiles.h"

#include <algorithm>
#include <utility>

#include "sim/host_clock.h"

namespace tools {

TimedTiles::TimedTiles(hw::TileSource& source, std::vector<TimedBlock> blocks, std::vector<std::uint32_t> marked,
                       std::optional<std::uint32_t> stop_at)
    : source_(source), blocks_(std::move(blocks)), marked_(std::move(marked)), stop_at_(stop_at) {}

const traces::TileWork* TimedTiles::next() {
  while (block_ < blocks_.size()) {
    const TimedBlock& block = blocks_[block_];
    const traces::TileWork* work = take_tile();
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
  while (const traces::TileWork* work = take_tile()) source_.give_back(work);
  return nullptr;
}

const traces::TileWork* TimedTiles::take_tile() {
  const double begin = sim::thread_seconds();
  const traces::TileWork* work = source_.next();
  making_seconds_ += sim::thread_seconds() - begin;
  return work;
}

void TimedTiles::give_back(const traces::TileWork* work) {
  back_.push_back(work->tile);
  source_.give_back(work);
}

void TimedTiles::note_dispatched(sim::Time now) {
  const std::uint32_t tile = waiting_.back();
  waiting_.pop_back();
  for (const std::uint32_t ended : back_) {
    std::ranges::find(simulated_.rbegin(), simulated_.rend(), ended, &TimedTile::tile)->end = now;
  }
  back_.clear();
  if (tile >= blocks_[dispatched_block_].end) dispatched_block_ += 1;
  if (std::ranges::binary_search(marked_, tile)) {
    gpu_->account_until(now);
    marks_.push_back({tile, now, gpu_->unit_reports(), gpu_->kernel_use()});
  }
  if (tile == blocks_[dispatched_block_].first) warm_caches();
  simulated_.push_back({tile, now, now});
  if (stop_at_ == tile) gpu_->stop_early();
}

void TimedTiles::warm_caches() {
  const sim::HostClock::time_point begin = sim::HostClock::now();
  std::uint32_t core = 0;
  for (const traces::TileWork* work : for_warming_) {
    gpu_->warm_caches(*work, core);
    core = core + 1 == gpu_->core_count() ? 0 : core + 1;
    source_.give_back(work);
  }
  warmed_ += for_warming_.size();
  for_warming_.clear();
  warming_seconds_ += sim::seconds_since(begin);
}

void TimedTiles::end_tiles() {
  for (TimedTile& tile : simulated_) {
    if (tile.end == tile.begin) tile.end = gpu_->elapsed_time();
  }
}

const Mark& TimedTiles::mark_at(std::uint32_t tile) const { return *std::ranges::find(marks_, tile, &Mark::tile); }

}  // namespace tools
