#include "hw_models/frame/tile_dispatcher.h"

#include <algorithm>

#include <fmt/format.h>

namespace hw {

TileDispatcher::TileDispatcher(TileSource& source, TilesInFlight tiles_per_core, Links links, sim::Clock clock,
                               std::span<const std::uint32_t> starts)
    : source_(source),
      tiles_per_core_(tiles_per_core),
      links_(std::move(links)),
      clock_(clock),
      next_(source.next()),
      in_flight_(links_.to_core.size()),
      start_at_(links_.to_core.size()) {
  for (std::size_t core = 0; core < starts.size(); ++core) start_at_[core] = clock.edge_after(0, starts[core]);
  importers_.reserve(tiles_per_core.max_tiles() * links_.to_core.size());
}

sim::Time TileDispatcher::tick(sim::Time now) {
  collect_messages(now);
  flush_l2(now);
  notify_importers(now);
  const bool dispatched = next_ != nullptr && !next_tile_must_wait() && dispatch_tile(now);
  const bool waits = next_ != nullptr && next_tile_must_wait();
  const CycleReason then = next_ == nullptr ? CycleReason::kIdle
                           : waits          ? CycleReason::kWaiting
                                            : CycleReason::kCoresFull;
  activity_.spend(now, clock_.period(), dispatched ? CycleReason::kDispatching : then, then);

  const sim::Time next = clock_.edge_after(now, 1);
  sim::Time at = sim::kNever;
  if (links_.from_builder != nullptr) at = std::max(next, links_.from_builder->pop_at());
  const bool builds = next_ != nullptr && !waits && next_->is_build();
  if (builds) at = std::min(at, std::max(next, links_.to_builder->push_at()));
  for (std::size_t core = 0; core < in_flight_.size(); ++core) {
    at = std::min(at, std::max(next, links_.from_core[core]->pop_at()));
    if (next_ != nullptr && !waits && !builds && has_room(core)) {
      at = std::min(at, std::max({next, links_.to_core[core]->push_at(), start_at_[core]}));
    }
  }
  for (const Importer& i : importers_) {
    if (i.update_pending) at = std::min(at, std::max(next, links_.to_core[i.core]->push_at()));
  }
  return at;
}

bool TileDispatcher::next_tile_must_wait() const {
  const std::uint64_t not_awaited = links_.builds_overlap ? builds_in_flight_ : 0;
  return next_->after_all && stats_.finished + not_awaited < stats_.dispatched;
}

bool TileDispatcher::has_room(std::size_t core) const {
  const bool later = is_later_pass_ || (next_->after_all && has_samples_);
  return in_flight_[core] < (later ? tiles_per_core_.later : tiles_per_core_.first);
}

bool TileDispatcher::dispatch_tile(sim::Time now) {
  if (next_->is_build()) return dispatch_build(now);
  const std::size_t cores = in_flight_.size();
  for (std::size_t k = 0; k < cores; ++k) {
    const std::size_t core = (turn_ + k) % cores;
    if (!has_room(core) || now < start_at_[core] || !links_.to_core[core]->can_push(now)) continue;
    is_later_pass_ |= next_->after_all && has_samples_;
    has_samples_ |= next_->samples != 0;
    in_flight_[core] += 1;
    turn_ = (core + 1) % cores;
    send_next(now, core, *links_.to_core[core]);
    return true;
  }
  return false;
}

bool TileDispatcher::dispatch_build(sim::Time now) {
  if (!links_.to_builder->can_push(now)) return false;
  builds_in_flight_ += 1;
  constexpr std::size_t kCore = 0;  // the builder is beside core 0, whose port it uses
  send_next(now, kCore, *links_.to_builder);
  return true;
}

void TileDispatcher::send_next(sim::Time now, std::size_t core, sim::Link<TileJob>& link) {
  const auto tag = static_cast<TileTag>(stats_.dispatched & kTileTagMask);
  if (links_.observer != nullptr) notify(*links_.observer, TileDispatched{tag, static_cast<std::uint32_t>(core), now});
  const TileJob job{next_, missing_borders(*next_), tag};
  link.push(now, job);
  if (job.missing != 0) {
    importers_.push_back({core, job});
    stats_.early += 1;
  }
  stats_.dispatched += 1;
  source_.note_dispatched(now);
  next_ = source_.next();
}

void TileDispatcher::collect_messages(sim::Time now) {
  if (links_.from_builder != nullptr && links_.from_builder->can_pop(now)) {
    builds_in_flight_ -= 1;
    note_finished(now, links_.from_builder->pop(now));
  }
  for (std::size_t core = 0; core < in_flight_.size(); ++core) {
    if (!links_.from_core[core]->can_pop(now)) continue;
    const TileDone done = links_.from_core[core]->pop(now);
    if (done.border != traces::WorkNode::kNone) {
      note_borders_written(done.work->tile, 1U << done.border);
      stats_.borders += 1;
      continue;
    }
    in_flight_[core] -= 1;
    note_finished(now, done);
  }
}

void TileDispatcher::note_finished(sim::Time now, const TileDone& done) {
  note_borders_written(done.work->tile,
                       (1U << traces::kMostBorders) - 1);  // a finished tile writes no more borders
  if (links_.observer != nullptr) notify(*links_.observer, TileFinished{done.tile, now});
  source_.release_work(done.work);
  stats_.finished += 1;
}

void TileDispatcher::note_borders_written(std::uint32_t tile, std::uint32_t borders) {
  if (written_.size() <= tile) written_.resize(std::size_t{tile} + 1);
  written_[tile] = static_cast<std::uint8_t>(written_[tile] | borders);
  for (Importer& i : importers_) {
    const std::uint32_t left = i.job.missing & missing_borders(*i.job.work);
    i.update_pending |= left != i.job.missing;
    i.job.missing = left;
  }
}

std::uint32_t TileDispatcher::missing_borders(const traces::TileWork& work) const {
  std::uint32_t bits = 0;
  for (std::size_t i = 0; i < work.imports.size(); ++i) {
    const auto [tile, number] = work.imports[i];
    if (tile >= written_.size() || (written_[tile] >> number & 1U) == 0) bits |= 1U << i;
  }
  return bits;
}

/// Sends an update to each core with a tile for which another imported border is now in memory, if the link has room.
void TileDispatcher::notify_importers(sim::Time now) {
  for (Importer& i : importers_) {
    if (!i.update_pending || !links_.to_core[i.core]->can_push(now)) continue;
    links_.to_core[i.core]->push(now, i.job);
    i.update_pending = false;
  }
  std::erase_if(importers_, [](const Importer& i) { return !i.update_pending && i.job.missing == 0; });
}

void TileDispatcher::flush_l2(sim::Time now) {
  if (flushed_ || !is_done()) return;
  flushed_ = true;
  for (sim::Link<Flush>* bank : links_.to_l2) bank->push(now, Flush{});
}

std::string TileDispatcher::state() const {
  const std::string next = next_ == nullptr        ? "none left"
                           : next_tile_must_wait() ? fmt::format("tile {} waits for all before it", next_->tile)
                                                   : "some left";
  return fmt::format("tiles dispatched {}, finished {}, of these without all borders {}, {}", stats_.dispatched,
                     stats_.finished, importers_.size(), next);
}

}  // namespace hw
