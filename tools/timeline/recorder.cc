#include "tools/timeline/recorder.h"

#include <algorithm>

namespace tools {

void TimelineRecorder::on_event(const hw::Event& event) {
  std::visit(hw::HandleEvents{
                 [&](const hw::TileStarted& e) { start_tile(e); },
                 [&](const hw::TileEnded& e) { end_tile(e); },
                 [&](const hw::LoopEnded& e) { add_loop(e); },
                 [&](const hw::BatchStarted& e) {
                   batches_[e.core].push_back({e.slot, e.node, static_cast<std::uint32_t>(e.rays), e.at});
                 },
                 [&](const hw::BatchEnded& e) { end_batch(e); },
                 [&](const hw::TransferEnded& e) { add_transfer(e); },
                 [&](const hw::L2LookedUp& e) { (e.hit ? bin_at(e.at).l2_hits : bin_at(e.at).l2_misses) += 1; },
                 [&](const hw::DramServed& e) {
                   (e.request.write ? bin_at(e.end).lines_written : bin_at(e.end).lines_read) += 1;
                 },
             },
             event);
}

/// Tags are entries of the tile list modulo 2^15; tiles in flight on a core have different tags.
std::uint32_t TimelineRecorder::entry_of(std::uint32_t core, hw::TileTag tile) const {
  const auto slot = std::ranges::find(slots_[core], tile, &Slot::owner);
  return slot == slots_[core].end() ? RecordedSlice::kNoEntry : slot->entry;
}

void TimelineRecorder::start_tile(const hw::TileStarted& event) {
  std::vector<Slot>& slots = slots_[event.core];
  if (slots.size() <= event.slot) slots.resize(event.slot + 1);
  slots[event.slot] = {event.tile, hw::tile_number_of_tag(event.tile, newest_), event.at};
  newest_ = std::max(newest_, slots[event.slot].entry);
}

void TimelineRecorder::end_tile(const hw::TileEnded& event) {
  Slot& tile = slots_[event.core][event.slot];
  slices_.push_back({.kind = RecordedSlice::Kind::kTile,
                     .core = static_cast<std::uint16_t>(event.core),
                     .slot = static_cast<std::uint16_t>(event.slot),
                     .entry = tile.entry,
                     .begin = tile.begin,
                     .end = event.at});
  tile = {};
}

void TimelineRecorder::add_loop(const hw::LoopEnded& loop) {
  slices_.push_back({.kind = RecordedSlice::Kind::kLoop,
                     .core = static_cast<std::uint16_t>(loop.core),
                     .kernel = loop.kernel,
                     .entry = entry_of(loop.core, loop.tile),
                     .amount = loop.items,
                     .launches = loop.launches,
                     .begin = loop.begin,
                     .end = loop.end,
                     .configured = loop.configured,
                     .start = loop.start,
                     .cycles = loop.cycles,
                     .stalled = loop.stalled});
}

void TimelineRecorder::end_batch(const hw::BatchEnded& event) {
  std::vector<Batch>& batches = batches_[event.core];
  const auto begun =
      std::ranges::find_if(batches, [&](const Batch& b) { return b.slot == event.slot && b.node == event.node; });
  slices_.push_back({.kind = RecordedSlice::Kind::kRays,
                     .what = static_cast<std::uint8_t>(event.batch->ray_kind),
                     .core = static_cast<std::uint16_t>(event.core),
                     .entry = slots_[event.core][event.slot].entry,
                     .amount = event.batch->items,
                     .rays_at_begin = begun->rays,
                     .rays_at_end = static_cast<std::uint32_t>(event.rays),
                     .begin = begun->begin,
                     .end = event.at});
  batches.erase(begun);
}

void TimelineRecorder::add_transfer(const hw::TransferEnded& transfer) {
  slices_.push_back({.kind = RecordedSlice::Kind::kTransfer,
                     .what = static_cast<std::uint8_t>(transfer.area),
                     .to_memory = transfer.to_memory,
                     .core = static_cast<std::uint16_t>(transfer.core),
                     .entry = entry_of(transfer.core, transfer.tile),
                     .amount = transfer.bytes,
                     .begin = transfer.begin,
                     .end = transfer.end});
}

}  // namespace tools
