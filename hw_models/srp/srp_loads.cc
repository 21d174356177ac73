#include <algorithm>
#include <bit>

#include "hw_models/srp/data_cache.h"
#include "hw_models/srp/srp.h"

namespace hw {

void Srp::fill(sim::Time now) {
  if (arrivals_.lines > now) return;
  const L1Cache::Miss miss = cache_.fill(links_.memory_in.pop(now).line);
  stats_.cache_fills += 1;
  stats_.cache_miss_cycles += clock_.cycles(now) - miss.asked_at;
  for (std::uint64_t waited = miss.slots; waited != 0; waited &= waited - 1) {
    const auto slot = static_cast<std::uint32_t>(std::countr_zero(waited));
    if (--lines_missing_[slot] == 0) missing_ &= ~(std::uint64_t{1} << slot);
  }
  full_ = false;
}

/// True if the lines that are needed at this point of array time have come; else the array stalls.
bool Srp::loads_in_time(sim::Time now) {
  if (run_.stalled_since != sim::kNever) {
    const bool late =
        !loads_.empty() && loads_.front().needed == array_time(now) && ((missing_ >> loads_.front().slot) & 1U) != 0;
    if (late || full_) return false;
    resume(now);
  }
  const sim::Time at = array_time(now);
  while (!loads_.empty() && loads_.front().needed <= at) {
    if ((missing_ >> loads_.front().slot) & 1U) {
      stall(now);
      return false;
    }
    loads_.pop_front();
  }
  return true;
}

/// The item that enters the loop now asks the data cache for its lines. False if the array stalled.
bool Srp::issue_loads(sim::Time now) {
  const sim::Time at = array_time(now);
  if (run_.next_item == run_.loading || at < sim::Time{run_.next_item} * run_.ii * clock_.period()) return true;
  const std::uint32_t slot = run_.next_item % kMostLoadCycles;
  if (!ask(now, run_.next_item)) {
    stall(now);
    return false;
  }
  if ((missing_ >> slot & 1U) != 0) loads_.push_back({at + config_.latency.cached() * clock_.period(), slot});
  run_.next_item += 1;
  issue_ready_hits();
  return true;
}

/// Issues items ahead of their time where that changes nothing: those that touch no line, and those whose lines are all
/// here while none is on its way, so that nothing is filled.
inline void Srp::issue_ready_hits() {
  for (; run_.next_item < run_.loading; ++run_.next_item) {
    if (accesses_of(run_.next_item).empty()) continue;
    if (cache_.outstanding() != 0) return;
    collect_lines(run_.next_item);
    if (!std::ranges::all_of(item_lines_, [&](Addr line) { return cache_.holds(line); })) return;
    for (const Addr line : item_lines_) cache_.access(line, 0);
    stats_.cache_accesses += item_lines_.size();
    stats_.cache_hits += item_lines_.size();
  }
}

/// An item of the present chunk asks for its lines, those it has not asked for yet. False if there is no MSHR
/// left.
inline bool Srp::ask(sim::Time now, std::uint32_t item) {
  const std::uint32_t slot = item % kMostLoadCycles;
  collect_lines(item);
  cache_.belongs(slot, tiles_[run_.parts.of(item).tile].owner());
  for (; run_.next_line < item_lines_.size(); ++run_.next_line) {
    stats_.cache_accesses += 1;
    const L1Cache::Result result = cache_.access(item_lines_[run_.next_line], slot, clock_.cycles(now));
    if (result == L1Cache::Result::kHit) {
      stats_.cache_hits += 1;
      continue;
    }
    stats_.cache_misses += 1;
    if (result == L1Cache::Result::kFull) {
      stats_.mshr_full += 1;
      full_ = true;
      return false;
    }
    lines_missing_[slot] += 1;
    missing_ |= std::uint64_t{1} << slot;
  }
  run_.next_line = 0;
  return true;
}

/// All items of an ideal shader core ask at once, as far as there are MSHRs. True when every line has come.
bool Srp::load_all(sim::Time now) {
  while (!full_ && run_.next_item < run_.loading && ask(now, run_.next_item)) run_.next_item += 1;
  if (full_ || cache_.outstanding() > 0) {
    if (run_.stalled_since == sim::kNever) stall(now);
    return false;
  }
  if (run_.stalled_since != sim::kNever) resume(now);
  return true;
}

/// Accesses of an item of the present loop.
inline std::span<const traces::Access> Srp::accesses_of(std::uint32_t item) const {
  const LoopPart& part = run_.parts.of(item);
  const traces::TileWork& work = tiles_[part.tile].work();
  const std::uint32_t* begin = &work.access_begin[work.nodes[part.node].first + part.first + item - part.begin];
  return std::span(work.accesses).subspan(begin[0], begin[1] - begin[0]);
}

void Srp::collect_lines(std::uint32_t item) {
  if (lines_of_ == item) return;
  lines_of_ = item;
  item_lines_.clear();
  for (const traces::Access& access : accesses_of(item)) {
    const LineSet lines = lines_of(access, *frame_.layout);
    for (std::uint32_t i = 0; i < lines.count; ++i) {
      if (std::ranges::find(item_lines_, lines.line[i]) == item_lines_.end()) item_lines_.push_back(lines.line[i]);
    }
  }
}

}  // namespace hw
