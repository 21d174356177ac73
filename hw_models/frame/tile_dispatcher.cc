#include "hw_models/frame/tile_dispatcher.h"

#include <algorithm>

#include <fmt/format.h>

namespace hw {

TileDispatcher::TileDispatcher(TileSource& source, std::uint32_t tiles_per_core, Links links, sim::Clock clock)
    : source_(source),
      tiles_per_core_(tiles_per_core),
      links_(std::move(links)),
      clock_(clock),
      next_(source.next()),
      in_flight_(links_.to_core.size()) {}

sim::Time TileDispatcher::tick(sim::Time now) {
  collect(now);
  flush(now);
  const bool dispatched = next_ != nullptr && !must_wait() && dispatch(now);
  const bool waits = next_ != nullptr && must_wait();
  const CycleReason then = next_ == nullptr ? CycleReason::kIdle
                           : waits          ? CycleReason::kWaiting
                                            : CycleReason::kCoresFull;
  activity_.spend(now, clock_.period(), dispatched ? CycleReason::kDispatching : then, then);

  const sim::Time next = clock_.after(now, 1);
  sim::Time at = sim::kNever;
  for (std::size_t core = 0; core < in_flight_.size(); ++core) {
    at = std::min(at, std::max(next, links_.from_core[core]->pop_at()));
    if (next_ != nullptr && !waits && in_flight_[core] < tiles_per_core_) {
      at = std::min(at, std::max(next, links_.to_core[core]->push_at()));
    }
  }
  return at;
}

bool TileDispatcher::must_wait() const {
  if (next_->after_all && stats_.finished < stats_.dispatched) return true;
  return std::ranges::any_of(next_->after,
                             [&](std::uint32_t tile) { return tile >= finished_.size() || !finished_[tile]; });
}

bool TileDispatcher::dispatch(sim::Time now) {
  const std::size_t cores = in_flight_.size();
  for (std::size_t k = 0; k < cores; ++k) {
    const std::size_t core = (turn_ + k) % cores;
    if (in_flight_[core] == tiles_per_core_ || !links_.to_core[core]->can_push(now)) continue;
    links_.to_core[core]->push(now, TileJob{next_});
    in_flight_[core] += 1;
    stats_.dispatched += 1;
    turn_ = (core + 1) % cores;
    source_.dispatched(now);
    next_ = source_.next();
    return true;
  }
  return false;
}

void TileDispatcher::collect(sim::Time now) {
  for (std::size_t core = 0; core < in_flight_.size(); ++core) {
    if (!links_.from_core[core]->can_pop(now)) continue;
    const traces::TileWork* work = links_.from_core[core]->pop(now).work;
    if (finished_.size() <= work->tile) finished_.resize(std::size_t{work->tile} + 1);
    finished_[work->tile] = true;
    source_.give_back(work);
    in_flight_[core] -= 1;
    stats_.finished += 1;
  }
}

void TileDispatcher::flush(sim::Time now) {
  if (flushed_ || !done()) return;
  flushed_ = true;
  for (sim::Link<Flush>* bank : links_.to_l2) bank->push(now, Flush{});
}

std::string TileDispatcher::state() const {
  const std::string next = next_ == nullptr ? "none left"
                           : must_wait()    ? fmt::format("tile {} waits for others", next_->tile)
                                            : "some left";
  return fmt::format("tiles dispatched {}, finished {}, {}", stats_.dispatched, stats_.finished, next);
}

}  // namespace hw
