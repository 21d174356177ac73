#include "hw_models/srp/srp.h"

#include <algorithm>
#include <bit>
#include <cassert>

#include <fmt/format.h>

#include "hw_models/srp/data_cache.h"

namespace hw {

using traces::WorkNode;

namespace {

constexpr std::uint32_t kTileShift = 24;  // a handle: tile in flight, then the ray's or node's index within the tile
constexpr std::uint32_t kIndexMask = (1U << kTileShift) - 1;
static_assert(kMaxRays == 1U << kTileShift);
constexpr std::uint32_t kSpillTag = 0xffffffffU;
constexpr std::uint64_t kAccess = 16;  // bytes of one access to the tile buffer
constexpr std::uint64_t kRayReads = sizeof(traces::Ray) / kAccess;
constexpr std::uint64_t kHitWrites = sizeof(traces::Hit) / kAccess;

}  // namespace

Srp::Srp(const SrpConfig& config, const TileBufferConfig& buffer, const Frame& frame, Links links, std::uint16_t port,
         sim::Clock clock)
    : config_(config),
      clock_(clock),
      frame_(frame),
      links_(links),
      buffer_(buffer, frame.tile_samples, frame.attribute_bytes, clock, frame.ideal_buffer),
      cache_(config.data_cache, port, frame.ideal_cache),
      tiles_(buffer.tiles_in_flight),
      lines_missing_(64),
      kernel_use_(frame.kernels.size()) {
  feeds_.reserve(64);
  item_lines_.reserve(64);
}

sim::Time Srp::tick(sim::Time now) {
  take_tile(now);
  take_hit(now);
  fill(now);
  take_dma(now);
  run_array(now);
  while (feed_ray(now) && frame_.ray_interval == 0) {
  }
  cache_.send(now, links_.memory_out);
  if (!dma_.empty() && links_.dma_out.can_push(now)) {
    links_.dma_out.push(now, dma_.front());
    dma_.pop_front();
  }
  const CycleReason reason = why(now);
  account(now);
  activity_.spend(now, clock_.period(), reason, reason);
  return next_wake(now);
}

/// Charges the time since the last tick to the state in which that left the core.
void Srp::account(sim::Time now) {
  const std::uint64_t cycles = clock_.cycles(now - accounted_);
  if (fed_) stats_.fed += cycles;
  if (fed_ && !busy_) stats_.awaited += cycles;
  accounted_ = now;
  fed_ = rays_out_ > 0;
  busy_ = run_.active;
}

void Srp::finish(sim::Time end) {
  account(end);
  activity_.finish(end);
  buffer_.finish(end);
}

void Srp::take_tile(sim::Time now) {
  if (by_age_.size() == tiles_.size() || !links_.tiles_in.can_pop(now)) return;
  const auto free = std::ranges::find_if(tiles_, [](const TileRun& t) { return !t.active(); });
  free->begin(*links_.tiles_in.pop(now).work, config_.chunk);
  if (by_age_.empty()) buffer_.in_use(now, true);
  by_age_.push_back(static_cast<std::uint32_t>(free - tiles_.begin()));
  stats_.tiles += 1;
  look_ = true;
  start_transfers(by_age_.back());
}

void Srp::take_hit(sim::Time now) {
  if (!links_.hits_in.can_pop(now)) return;
  const std::uint32_t id = links_.hits_in.pop(now).id;
  buffer_.write(kHitWrites);
  if (--rays_out_ == 0) empty_since_ = now;
  stats_.hits += 1;
  const std::uint32_t tile = id >> kTileShift;
  const bool news = tiles_[tile].finish_ray(id & kIndexMask);
  if (news) start_transfers(tile);
  if (news || rays_out_ == 0) look_ = true;
}

void Srp::fill(sim::Time now) {
  if (!links_.memory_in.can_pop(now)) return;
  const L1Cache::Miss miss = cache_.fill(links_.memory_in.pop(now).line);
  stats_.cache_fills += 1;
  stats_.cache_miss_cycles += clock_.cycles(now) - miss.asked_at;
  for (std::uint64_t waited = miss.slots; waited != 0; waited &= waited - 1) {
    const auto slot = static_cast<std::uint32_t>(std::countr_zero(waited));
    if (--lines_missing_[slot] == 0) missing_ &= ~(std::uint64_t{1} << slot);
  }
  full_ = false;
}

void Srp::take_dma(sim::Time now) {
  if (!links_.dma_in.can_pop(now)) return;
  const std::uint32_t tag = links_.dma_in.pop(now).tag;
  if (tag == kSpillTag) {
    spills_done_ += 1;
    look_ = true;
    return;
  }
  const std::uint32_t tile = tag >> kTileShift, node = tag & kIndexMask;
  if (tiles_[tile].is_awaited(node)) transfers_awaited_ -= 1;
  finish_items(now, tile, node, tiles_[tile].node(node).items);
}

void Srp::run_array(sim::Time now) {
  if (run_.active && now >= run_.start) {
    const bool flowing = frame_.ideal ? load_all(now) : loads_in_time(now) && issue_loads(now);
    if (flowing && run_.next_item == run_.loading && loads_.empty() && now >= leaves_at(run_.items - 1)) {
      finish_chunk(now);
    }
  }
  if (!run_.active && look_) start_chunk(now);
}

/// Lines that are needed at this point of array time have come, or the array freezes.
bool Srp::loads_in_time(sim::Time now) {
  if (run_.frozen != sim::kNever) {
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

/// The item that enters the loop now asks the data cache for its lines. False if the array froze.
bool Srp::issue_loads(sim::Time now) {
  const sim::Time at = array_time(now);
  if (run_.next_item == run_.loading || at < sim::Time{run_.next_item} * run_.ii * clock_.period()) return true;
  const std::uint32_t slot = run_.next_item % 64;
  if (!ask(now, run_.next_item)) {
    stall(now);
    return false;
  }
  if ((missing_ >> slot & 1U) != 0) loads_.push_back({at + config_.latency.cached_load * clock_.period(), slot});
  run_.next_item += 1;
  issue_ready_hits();
  return true;
}

/// Items that touch nothing need not be looked at. Nor do those whose lines are all here while none is on its way, so
/// that nothing is filled: they read their lines ahead of their time.
void Srp::issue_ready_hits() {
  const traces::TileWork& work = tiles_[run_.tile].work();
  const WorkNode& node = tiles_[run_.tile].node(run_.node);
  const std::uint32_t* const begin = &work.access_begin[node.first + run_.first];
  for (; run_.next_item < run_.loading; ++run_.next_item) {
    if (begin[run_.next_item] == begin[run_.next_item + 1]) continue;
    if (cache_.outstanding() != 0) return;
    collect_lines(node, run_.first + run_.next_item);
    if (!std::ranges::all_of(item_lines_, [&](Addr line) { return cache_.holds(line); })) return;
    for (const Addr line : item_lines_) cache_.access(line, 0);
    stats_.cache_accesses += item_lines_.size();
    stats_.cache_hits += item_lines_.size();
  }
}

/// An item of the present chunk asks for its lines, those it has not asked for yet. False if there is no MSHR
/// left.
bool Srp::ask(sim::Time now, std::uint32_t item) {
  const std::uint32_t slot = item % 64;
  collect_lines(tiles_[run_.tile].node(run_.node), run_.first + item);
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
    if (run_.frozen == sim::kNever) stall(now);
    return false;
  }
  if (run_.frozen != sim::kNever) resume(now);
  return true;
}

void Srp::collect_lines(const WorkNode& node, std::uint32_t item) {
  const traces::TileWork& work = tiles_[run_.tile].work();
  item_lines_.clear();
  for (std::uint32_t a = work.access_begin[node.first + item]; a < work.access_begin[node.first + item + 1]; ++a) {
    const LineSet lines = lines_of(work.accesses[a], *frame_.layout);
    for (std::uint32_t i = 0; i < lines.count; ++i) {
      if (std::ranges::find(item_lines_, lines.line[i]) == item_lines_.end()) item_lines_.push_back(lines.line[i]);
    }
  }
}

void Srp::finish_chunk(sim::Time now) {
  KernelUse& use = kernel_use_[tiles_[run_.tile].node(run_.node).kernel];
  use.cycles += clock_.cycles(now - run_.begin);
  use.starved += clock_.cycles(time_without_rays(now) - run_.without_rays);
  run_.active = false;
  finish_items(now, run_.tile, run_.node, run_.items);
}

void Srp::finish_items(sim::Time now, std::uint32_t tile, std::uint32_t node, std::uint32_t items) {
  buffer_.give_back(tiles_[tile].finish_items(node, items));
  look_ = true;
  start_transfers(tile);
  end_tile(now, tile);
}

void Srp::start_transfers(std::uint32_t tile) {
  tiles_[tile].start_transfers([&](std::uint32_t n) {
    const WorkNode& node = tiles_[tile].node(n);
    const Area area = area_of(node.region);
    const Addr base = frame_.areas[static_cast<std::size_t>(area)] + node.offset;
    dma_.push_back({base, node.items, node.to_memory, (tile << kTileShift) | n, area});
    const std::uint64_t accesses = (node.items + kAccess - 1) / kAccess;
    if (node.to_memory) {
      buffer_.read(accesses);
    } else {
      buffer_.write(accesses);
    }
    if (tiles_[tile].is_awaited(n)) transfers_awaited_ += 1;
  });
}

void Srp::end_tile(sim::Time now, std::uint32_t tile) {
  if (!tiles_[tile].active() || !tiles_[tile].all_complete()) return;
  assert(links_.tiles_out.can_push(now) && "as many places as tiles in flight");
  links_.tiles_out.push(now, TileDone{&tiles_[tile].work()});
  tiles_[tile].end();
  std::erase(by_age_, tile);
  if (by_age_.empty()) buffer_.in_use(now, false);
  look_ = true;
}

bool Srp::fits(std::uint32_t tile, std::uint32_t node) const {
  const TileRun& run = tiles_[tile];
  const std::uint64_t rays = run.rays_made(node, run.done(node), run.chunk_items(node));
  if (rays == 0) return true;
  const bool first_rays_of_younger = tile != by_age_.front() && !run.follows_rays(node);
  return buffer_.free() >= rays + (first_rays_of_younger ? frame_.tile_samples : 0);
}

void Srp::start_chunk(sim::Time now) {
  look_ = false;
  blocked_ = false;
  for (const std::uint32_t tile : by_age_) {
    const std::uint32_t node = tiles_[tile].next_launch([&](std::uint32_t n) {
      if (fits(tile, n)) return true;
      blocked_ = true;
      return false;
    });
    if (node != TileRun::kNone) return begin_chunk(now, tile, node);
  }
  const bool rays_can_go = std::ranges::any_of(feeds_, [&](const Feed& f) { return feed_at(f) != sim::kNever; });
  const bool data_come = spills_done_ < spills_asked_ || transfers_awaited_ > 0;
  if (!blocked_ || rays_out_ > 0 || rays_can_go || data_come) return;
  for (const std::uint32_t tile : by_age_) {
    const std::uint32_t node = tiles_[tile].next_launch([](std::uint32_t) { return true; });
    if (node != TileRun::kNone) return begin_chunk(now, tile, node);
  }
}

void Srp::begin_chunk(sim::Time now, std::uint32_t tile, std::uint32_t node) {
  TileRun& run = tiles_[tile];
  const WorkNode& work = run.node(node);
  const KernelSchedule& kernel = frame_.kernels[work.kernel];
  const bool switching = configured_ != work.kernel && !frame_.ideal;
  blocked_ = false;
  configured_ = work.kernel;
  const std::uint32_t items = run.chunk_items(node);
  const bool conflicts = !frame_.ideal && !frame_.ideal_buffer;
  const std::uint64_t conflict_cycles = conflicts ? frame_.conflicts[work.kernel].of(items) : 0;
  const sim::Time configured = clock_.after(now, switching ? config_.switch_cycles : 0);
  const std::uint32_t first = run.done(node), working = run.working(node, first, items);
  run_ = Run{.active = true,
             .tile = tile,
             .node = node,
             .first = first,
             .items = items,
             .loading = work.has_accesses ? working : 0,
             .begin = now,
             .without_rays = time_without_rays(now),
             .configured = configured,
             .start = clock_.after(configured, conflict_cycles),
             .ii = frame_.ideal ? 0 : kernel.ii,
             .depth = frame_.ideal ? 1 : kernel.depth};
  if (switching) {
    stats_.switches += 1;
    stats_.config_rows_loaded += kernel.ii;
  }
  stats_.add(kernel, items);
  buffer_.read(std::uint64_t{items} * kernel.local_reads);
  buffer_.write(std::uint64_t{items} * kernel.local_writes);
  buffer_.conflict(conflict_cycles);
  kernel_use_[work.kernel].launches += 1;
  kernel_use_[work.kernel].items += items;
  kernel_use_[work.kernel].idle += items - working;

  const std::uint64_t spilled = buffer_.take(run.rays_made(node, run_.first, items));
  for (const std::uint32_t batch : run.batches_of(node)) {
    if (run_.first == 0) feeds_.push_back({tile, batch, 0, 0});
  }
  if (spilled == 0) return;
  // Ray out and in again before it is issued, then its hit out and in again before it is shaded.
  const auto bytes = static_cast<std::uint32_t>(2 * spilled * buffer_.slot_bytes());
  buffer_.read(bytes / kAccess);
  buffer_.write(bytes / kAccess);
  const Addr spill = frame_.areas[static_cast<std::size_t>(Area::kSpill)];
  dma_.push_back({spill, bytes, true, kSpillTag, Area::kSpill});
  dma_.push_back({spill, bytes, false, kSpillTag, Area::kSpill});
  spills_asked_ += 2;
  for (Feed& f : feeds_) {
    if (f.tile == tile && run.producer(f.batch) == node) f.after_spill = spills_asked_;
  }
}

sim::Time Srp::feed_at(const Feed& feed) const {
  if (spills_done_ < feed.after_spill) return sim::kNever;
  const TileRun& run = tiles_[feed.tile];
  const std::uint32_t launch = run.producer(feed.batch);
  const std::uint32_t item = run.source(feed.batch, feed.next);
  if (item < run.done(launch)) return 0;
  const bool running = run_.active && run_.tile == feed.tile && run_.node == launch && item < run_.first + run_.items;
  if (!running) return sim::kNever;
  if (frame_.ideal && run_.frozen != sim::kNever) return sim::kNever;
  const sim::Time leaves = leaves_at(item - run_.first);
  return leaves <= run_.frozen ? leaves : sim::kNever;
}

bool Srp::feed_ray(sim::Time now) {
  if (feeds_.empty() || now < feed_free_at_ || !links_.rays_out.can_push(now)) return false;
  const auto feed = std::ranges::find_if(feeds_, [&](const Feed& f) { return feed_at(f) <= now; });
  if (feed == feeds_.end()) return false;
  const TileRun& run = tiles_[feed->tile];
  const std::uint32_t ray = run.node(feed->batch).first + feed->next;
  const traces::TileWork& work = run.work();
  links_.rays_out.push(now, RayJob{work.walk.data() + work.ray_begin[ray], (feed->tile << kTileShift) | ray});
  buffer_.read(kRayReads);
  without_rays_ = time_without_rays(now);
  rays_out_ += 1;
  stats_.rays += 1;
  feed_free_at_ = clock_.edge_at_or_after(now + frame_.ray_interval);
  if (++feed->next == run.node(feed->batch).items) feeds_.erase(feed);
  return true;
}

Srp::CycleReason Srp::why(sim::Time now) const {
  if (run_.active) {
    if (now < run_.configured) return CycleReason::kSwitching;
    if (now < run_.start) return CycleReason::kBanks;
    return run_.frozen == sim::kNever ? CycleReason::kRunning : CycleReason::kCacheMiss;
  }
  if (by_age_.empty()) return CycleReason::kStarved;
  return blocked_ ? CycleReason::kNoSlots : CycleReason::kWaiting;
}

sim::Time Srp::next_wake(sim::Time now) const {
  const sim::Time next = clock_.after(now, 1);
  if (!run_.active && look_) return next;
  sim::Time at = sim::kNever;
  if (run_.active && now < run_.start) {
    at = now < run_.configured ? run_.configured : run_.start;
  } else if (run_.active && run_.frozen == sim::kNever) {
    const sim::Time origin = run_.start + run_.stalled;
    at = leaves_at(run_.items - 1);
    if (run_.next_item < run_.loading) at = origin + sim::Time{run_.next_item} * run_.ii * clock_.period();
    if (!loads_.empty()) at = std::min(at, origin + loads_.front().needed);
    at = std::max(at, next);
  }
  if (!feeds_.empty()) {
    const sim::Time open = std::max({next, feed_free_at_, links_.rays_out.push_at()});
    for (auto f = feeds_.begin(); f != feeds_.end() && open < at; ++f) at = std::min(at, std::max(open, feed_at(*f)));
  }
  if (!dma_.empty()) at = std::min(at, std::max(next, links_.dma_out.push_at()));
  if (by_age_.size() < tiles_.size()) at = std::min(at, std::max(next, links_.tiles_in.pop_at()));
  at = std::min(at, std::max(next, links_.hits_in.pop_at()));
  at = std::min(at, std::max(next, links_.memory_in.pop_at()));
  at = std::min(at, std::max(next, links_.dma_in.pop_at()));
  return std::min(at, cache_.send_at(next, links_.memory_out));
}

std::string Srp::state() const {
  std::string tiles;
  for (const std::uint32_t t : by_age_) {
    const TileRun& run = tiles_[t];
    tiles += fmt::format("; tile {}:", run.work().tile);
    for (std::uint32_t n = 0; n < run.nodes(); ++n) {
      if (!run.complete(n)) tiles += fmt::format(" node {} {}/{}", n, run.done(n), run.total(n));
    }
  }
  return fmt::format("{}, rays in T&I {}, ray slots {}/{}, feeds {}, DMA jobs {}{}",
                     run_.active ? (run_.frozen == sim::kNever ? "running" : "frozen") : "array idle", rays_out_,
                     buffer_.used(), buffer_.slots(), feeds_.size(), dma_.size(), tiles);
}

}  // namespace hw
