#include "tools/timeline/recorder.h"

#include <algorithm>

namespace tools {

/// Owners are entries of the tile list, as far as 15 bits go: of those that a core has, no two are the same.
std::uint32_t TimelineRecorder::entry_of(std::uint32_t core, hw::Owner tile) const {
  const auto slot = std::ranges::find(slots_[core], tile, &Slot::owner);
  return slot == slots_[core].end() ? RecordedSlice::kNoEntry : slot->entry;
}

void TimelineRecorder::tile_begins(std::uint32_t core, std::uint32_t slot, hw::Owner tile, sim::Time now) {
  if (slots_[core].size() <= slot) slots_[core].resize(slot + 1);
  slots_[core][slot] = {tile, hw::TileBook::number_near(tile, newest_), now};
  newest_ = std::max(newest_, slots_[core][slot].entry);
}

void TimelineRecorder::tile_ends(std::uint32_t core, std::uint32_t slot, sim::Time now) {
  Slot& tile = slots_[core][slot];
  slices_.push_back({.kind = RecordedSlice::Kind::kTile,
                     .core = static_cast<std::uint16_t>(core),
                     .slot = static_cast<std::uint16_t>(slot),
                     .entry = tile.entry,
                     .begin = tile.begin,
                     .end = now});
  tile = {};
}

void TimelineRecorder::loop_ends(std::uint32_t core, const hw::ObservedLoop& loop) {
  slices_.push_back({.kind = RecordedSlice::Kind::kLoop,
                     .core = static_cast<std::uint16_t>(core),
                     .kernel = loop.kernel,
                     .entry = entry_of(core, loop.tile),
                     .amount = loop.items,
                     .launches = loop.launches,
                     .begin = loop.begin,
                     .end = loop.end,
                     .configured = loop.configured,
                     .start = loop.start,
                     .cycles = loop.cycles,
                     .stalled = loop.stalled});
}

void TimelineRecorder::batch_begins(std::uint32_t core, std::uint32_t slot, std::uint32_t node, std::uint64_t rays,
                                    sim::Time now) {
  batches_[core].push_back({slot, node, static_cast<std::uint32_t>(rays), now});
}

void TimelineRecorder::batch_ends(std::uint32_t core, std::uint32_t slot, std::uint32_t node,
                                  const traces::WorkNode& batch, std::uint64_t rays, sim::Time now) {
  const auto begun =
      std::ranges::find_if(batches_[core], [&](const Batch& b) { return b.slot == slot && b.node == node; });
  slices_.push_back({.kind = RecordedSlice::Kind::kRays,
                     .what = static_cast<std::uint8_t>(batch.ray_kind),
                     .core = static_cast<std::uint16_t>(core),
                     .entry = slots_[core][slot].entry,
                     .amount = batch.items,
                     .rays_at_begin = begun->rays,
                     .rays_at_end = static_cast<std::uint32_t>(rays),
                     .begin = begun->begin,
                     .end = now});
  batches_[core].erase(begun);
}

void TimelineRecorder::transfer_ends(std::uint32_t core, const hw::DmaJob& job, sim::Time begin, sim::Time end) {
  slices_.push_back({.kind = RecordedSlice::Kind::kTransfer,
                     .what = static_cast<std::uint8_t>(job.area),
                     .to_memory = job.write,
                     .core = static_cast<std::uint16_t>(core),
                     .entry = entry_of(core, job.owner),
                     .amount = job.bytes,
                     .begin = begin,
                     .end = end});
}

}  // namespace tools
