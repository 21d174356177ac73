#include "hw_models/srp/srp.h"

#include <algorithm>
#include <bit>
#include <cassert>
#include <utility>

#include <fmt/format.h>

#include "hw_models/srp/data_cache.h"

namespace hw {

using traces::WorkNode;

Srp::Srp(const SrpConfig& config, const TileBufferConfig& buffer, const Frame& frame, Links links, std::uint16_t client,
         sim::Clock clock)
    : config_(config),
      clock_(clock),
      frame_(frame),
      links_(links),
      buffer_(buffer, frame.needs, clock, frame.ideal_buffer),
      cache_(config.data_cache, client, frame.ideal_cache),
      tiles_(tiles_in_flight(buffer, frame.needs, frame.ideal_buffer).max_tiles()),
      launch_{.config_memory = ConfigMemory(config.config_memory.bytes, frame.kernels.size())},
      kernel_use_(frame.kernels.size()) {
  links_.tiles_in.store_pop_time_in(&arrivals_.tiles);
  links_.hits_in.store_pop_time_in(&arrivals_.hits);
  links_.memory_in.store_pop_time_in(&arrivals_.lines);
  links_.dma_in.store_pop_time_in(&arrivals_.transfers);
  loads_.lines_missing.resize(kMostLoadCycles);
  rays_.feeds.reserve(64);
  loop_.chunks.reserve(64);
  loads_.lines.reserve(64);
}

sim::Time Srp::tick(sim::Time now) {
  if (arrivals_.tiles <= now) take_tile(now);
  take_hit(now);
  fill_arrived_line(now);
  take_finished_transfer(now);
  if (links_.raster_out != nullptr) service_rasteriser_links(now);
  run_array(now);
  while (feed_ray(now) && frame_.ray_interval == 0) {
  }
  cache_.send_request(now, links_.memory_out);
  if (!transfers_.dma.empty() && links_.dma_out.can_push(now)) {
    links_.dma_out.push(now, transfers_.dma.front());
    transfers_.dma.pop_front();
  }
  const CycleReason reason = current_reason(now);
  account_until(now);
  activity_.spend(now, clock_.period(), reason, reason);
  return next_wake(now);
}

/// Adds the cycles since the last tick to the counters `fed` (cycles in which the T&I unit had rays) and `awaited`
/// (those in which the array was also idle).
inline void Srp::account_until(sim::Time now) {
  const std::uint64_t cycles = clock_.cycles(now - occupancy_.until);
  if (occupancy_.tni_had_rays) stats_.fed += cycles;
  if (occupancy_.tni_had_rays && !occupancy_.array_was_busy) stats_.awaited += cycles;
  occupancy_.until = now;
  occupancy_.tni_had_rays = rays_.in_flight > 0;
  occupancy_.array_was_busy = loop_.active;
}

void Srp::finish(sim::Time end) {
  if (end > occupancy_.until) account_until(end);
  activity_.finish(end);
  buffer_.finish(end);
}

inline Srp::CycleReason Srp::current_reason(sim::Time now) const {
  if (loop_.active) {
    if (now < loop_.configured) return CycleReason::kSwitching;
    if (now < loop_.start) return CycleReason::kBanks;
    return !loop_.is_stalled() ? CycleReason::kRunning : CycleReason::kCacheMiss;
  }
  if (by_age_.empty()) return CycleReason::kStarved;
  if (launch_.is_blocked) return CycleReason::kNoSlots;
  const bool moves = rays_.in_flight > 0 || !rays_.feeds.empty() || transfers_.awaited > 0;
  const bool borders =
      !moves && std::ranges::any_of(by_age_, [&](std::uint32_t t) { return tiles_[t].is_awaiting_border(); });
  return borders ? CycleReason::kBorders : CycleReason::kWaiting;
}

inline sim::Time Srp::next_wake(sim::Time now) const {
  const sim::Time next = clock_.edge_after(now, 1);
  if (!loop_.active && launch_.check_pending) return next;
  sim::Time at = sim::kNever;
  if (loop_.active && now < loop_.start) {
    at = now < loop_.configured ? loop_.configured : loop_.start;
  } else if (loop_.active && !loop_.is_stalled()) {
    const sim::Time origin = loop_.start + loop_.stall_time;
    at = loop_.item_end(clock_, loop_.chunks.item_count() - 1);
    if (loop_.next_item < loop_.loading) at = origin + sim::Time{loop_.next_item} * loop_.ii * clock_.period();
    if (!loads_.queue.empty()) at = std::min(at, origin + loads_.queue.front().needed);
    at = std::max(at, next);
  }
  if (!rays_.feeds.empty()) {
    const sim::Time open = std::max({next, rays_.next_at, links_.rays_out.push_at()});
    for (auto f = rays_.feeds.begin(); f != rays_.feeds.end() && open < at; ++f)
      at = std::min(at, std::max(open, ray_ready_at(*f)));
  }
  if (!transfers_.dma.empty()) at = std::min(at, std::max(next, links_.dma_out.push_at()));
  if (arrivals_.tiles != sim::kNever && has_room(links_.tiles_in.front())) {
    at = std::min(at, std::max(next, arrivals_.tiles));
  }
  at = std::min(at, std::max(next, std::min({arrivals_.hits, arrivals_.lines, arrivals_.transfers})));
  if (links_.raster_out != nullptr) {
    at = std::min(at, std::max(next, links_.raster_in->pop_at()));
    if (!transfers_.raster.empty()) at = std::min(at, std::max(next, links_.raster_out->push_at()));
  }
  return std::min(at, cache_.next_send_time(next, links_.memory_out));
}

std::string Srp::state() const {
  std::string tiles;
  for (const std::uint32_t t : by_age_) {
    const TileRun& run = tiles_[t];
    tiles += fmt::format("; tile {}:", run.work().tile);
    for (std::uint32_t n = 0; n < run.node_count(); ++n) {
      if (!run.is_complete(n)) tiles += fmt::format(" node {} {}/{}", n, run.done_items(n), run.total_items(n));
    }
  }
  return fmt::format("{}, rays in T&I {}, ray slots {}/{}, feeds {}, DMA jobs {}{}",
                     loop_.active ? (!loop_.is_stalled() ? "running" : "stalled") : "array idle", rays_.in_flight,
                     buffer_.used_slots(), buffer_.slot_count(), rays_.feeds.size(), transfers_.dma.size(), tiles);
}

// Functions that handle tiles.

void Srp::take_tile(sim::Time now) {
  if (!has_room(links_.tiles_in.front())) return;
  const TileJob job = links_.tiles_in.pop(now);
  std::uint32_t tile = find_in_flight_slot(job);
  launch_.check_pending = true;
  if (tile != tiles_.size()) {
    tiles_[tile].set_missing_borders(job.missing);
    return start_transfers(tile);
  }
  tile = static_cast<std::uint32_t>(std::ranges::find_if_not(tiles_, &TileRun::is_active) - tiles_.begin());
  tiles_[tile].start_tile(*job.work, config_.chunk, job.missing, job.tile);
  if (by_age_.empty()) buffer_.set_in_use(now, true);
  by_age_.push_back(tile);
  stats_.tiles += 1;
  if (frame_.observer != nullptr) notify(*frame_.observer, TileStarted{frame_.core, tile, job.tile, now});
  start_transfers(tile);
}

std::uint32_t Srp::find_in_flight_slot(const TileJob& job) const {
  const auto tile = std::ranges::find_if(by_age_, [&](std::uint32_t t) { return &tiles_[t].work() == job.work; });
  return tile == by_age_.end() ? static_cast<std::uint32_t>(tiles_.size()) : *tile;
}

void Srp::finish_items(sim::Time now, std::uint32_t tile, std::uint32_t node, std::uint32_t items) {
  buffer_.free_ray_slots(tiles_[tile].finish_items(node, items));
  launch_.check_pending = true;
  start_transfers(tile);
  end_tile(now, tile);
}

void Srp::end_tile(sim::Time now, std::uint32_t tile) {
  if (!tiles_[tile].is_active() || !tiles_[tile].is_tile_complete()) return;
  assert(links_.tiles_out.can_push(now) && "room for all messages of tiles in flight");
  links_.tiles_out.push(now, TileDone{&tiles_[tile].work(), WorkNode::kNone, tiles_[tile].tile_tag()});
  if (frame_.observer != nullptr) notify(*frame_.observer, TileEnded{frame_.core, tile, now});
  tiles_[tile].clear_tile();
  std::erase(by_age_, tile);
  if (by_age_.empty()) buffer_.set_in_use(now, false);
  launch_.check_pending = true;
}

// Functions that run the loop on the array and its loads.

inline void Srp::run_array(sim::Time now) {
  if (loop_.active && now >= loop_.start) {
    const bool flowing = frame_.ideal ? load_all_items(now) : ensure_loads_in_time(now) && issue_loads(now);
    if (flowing && loop_.next_item == loop_.loading && loads_.queue.empty() &&
        now >= loop_.item_end(clock_, loop_.chunks.item_count() - 1)) {
      finish_chunk(now);
    }
  }
  if (!loop_.active && launch_.check_pending) start_chunk(now);
}

void Srp::finish_chunk(sim::Time now) {
  KernelUse& use = kernel_use_[loop_.kernel];
  const std::uint64_t cycles = clock_.cycles(now - loop_.begin);
  use.cycles += cycles;
  use.starved += clock_.cycles(rays_.time_without_rays(now) - loop_.without_rays);
  if (frame_.observer != nullptr) notify_loop_end(now, cycles);
  loop_.active = false;
  for (const LoopChunk& part : loop_.chunks) finish_items(now, part.tile, part.node, part.items);
}

/// Notifies the observer that the loop on the array has ended. The loop's cycles are divided among its chunks in
/// proportion to their items, in whole cycles whose sum is exact.
void Srp::notify_loop_end(sim::Time now, std::uint64_t cycles) const {
  std::uint64_t items = 0, charged = 0;
  for (const LoopChunk& part : loop_.chunks) {
    items += part.items;
    const std::uint64_t until = cycles * items / loop_.chunks.item_count();
    notify(*frame_.observer, LoopCharged{tiles_[part.tile].tile_tag(), until - charged});
    charged = until;
  }
  notify(*frame_.observer, LoopEnded{.core = frame_.core,
                                     .kernel = loop_.kernel,
                                     .begin = loop_.begin,
                                     .configured = loop_.configured,
                                     .start = loop_.start,
                                     .end = now,
                                     .stalled = loop_.stall_time,
                                     .cycles = cycles,
                                     .items = loop_.chunks.item_count(),
                                     .launches = static_cast<std::uint32_t>(loop_.chunks.size()),
                                     .tile = tiles_[loop_.chunks.begin()->tile].tile_tag()});
}

void Srp::fill_arrived_line(sim::Time now) {
  if (arrivals_.lines > now) return;
  const L1Cache::Miss miss = cache_.fill_line(links_.memory_in.pop(now).line);
  stats_.cache_fills += 1;
  stats_.cache_miss_cycles += clock_.cycles(now) - miss.requested_at;
  for (std::uint64_t waited = miss.slots; waited != 0; waited &= waited - 1) {
    const auto slot = static_cast<std::uint32_t>(std::countr_zero(waited));
    if (--loads_.lines_missing[slot] == 0) loads_.missing &= ~(std::uint64_t{1} << slot);
  }
  loads_.mshrs_full = false;
}

/// Stalls the array unless all cache lines that the loop needs by now have arrived. Returns true if they have.
bool Srp::ensure_loads_in_time(sim::Time now) {
  if (loop_.is_stalled()) {
    const bool late = !loads_.queue.empty() && loads_.queue.front().needed == loop_.array_time(now) &&
                      ((loads_.missing >> loads_.queue.front().slot) & 1U) != 0;
    if (late || loads_.mshrs_full) return false;
    loop_.end_stall(now);
  }
  const sim::Time at = loop_.array_time(now);
  while (!loads_.queue.empty() && loads_.queue.front().needed <= at) {
    if ((loads_.missing >> loads_.queue.front().slot) & 1U) {
      loop_.begin_stall(now);
      return false;
    }
    loads_.queue.pop_front();
  }
  return true;
}

/// Requests the cache lines of the item that enters the array loop now, if an item enters. Returns false if the array
/// stalls because no MSHR is free.
bool Srp::issue_loads(sim::Time now) {
  const sim::Time at = loop_.array_time(now);
  if (loop_.next_item == loop_.loading || at < sim::Time{loop_.next_item} * loop_.ii * clock_.period()) return true;
  const std::uint32_t slot = loop_.next_item % kMostLoadCycles;
  if (!request_lines(now, loop_.next_item)) {
    loop_.begin_stall(now);
    return false;
  }
  if ((loads_.missing >> slot & 1U) != 0)
    loads_.queue.push_back({at + config_.latency.cached_load_latency() * clock_.period(), slot});
  loop_.next_item += 1;
  issue_loads_that_hit();
  return true;
}

/// Fast path: handles the loads of later loop items early if that changes no result. This holds for items without cache
/// lines. It also holds for items that hit while no miss is outstanding, because no fill can then precede them.
inline void Srp::issue_loads_that_hit() {
  for (; loop_.next_item < loop_.loading; ++loop_.next_item) {
    if (accesses_of(loop_.next_item).empty()) continue;
    if (cache_.outstanding_misses() != 0) return;
    collect_lines(loop_.next_item);
    if (!std::ranges::all_of(loads_.lines, [&](Addr line) { return cache_.has_line(line); })) return;
    for (const Addr line : loads_.lines) cache_.access_line(line, 0);
    stats_.cache_accesses += loads_.lines.size();
    stats_.cache_hits += loads_.lines.size();
  }
}

/// Requests the remaining cache lines of a loop item. Returns false if no MSHR of the data cache is free.
inline bool Srp::request_lines(sim::Time now, std::uint32_t item) {
  const std::uint32_t slot = item % kMostLoadCycles;
  collect_lines(item);
  cache_.set_slot_tile(slot, tiles_[loop_.chunks.chunk_of(item).tile].tile_tag());
  for (; loop_.next_line < loads_.lines.size(); ++loop_.next_line) {
    stats_.cache_accesses += 1;
    const L1Cache::Result result = cache_.access_line(loads_.lines[loop_.next_line], slot, clock_.cycles(now));
    if (result == L1Cache::Result::kHit) {
      stats_.cache_hits += 1;
      continue;
    }
    stats_.cache_misses += 1;
    if (result == L1Cache::Result::kFull) {
      stats_.mshr_full += 1;
      loads_.mshrs_full = true;
      return false;
    }
    loads_.lines_missing[slot] += 1;
    loads_.missing |= std::uint64_t{1} << slot;
  }
  loop_.next_line = 0;
  return true;
}

/// For an ideal shader core: requests all cache lines of the loop as fast as MSHRs allow. True once all have arrived.
bool Srp::load_all_items(sim::Time now) {
  while (!loads_.mshrs_full && loop_.next_item < loop_.loading && request_lines(now, loop_.next_item))
    loop_.next_item += 1;
  if (loads_.mshrs_full || cache_.outstanding_misses() > 0) {
    if (!loop_.is_stalled()) loop_.begin_stall(now);
    return false;
  }
  if (loop_.is_stalled()) loop_.end_stall(now);
  return true;
}

/// Returns the data cache accesses of an item of the loop on the array.
inline std::span<const traces::Access> Srp::accesses_of(std::uint32_t item) const {
  const LoopChunk& part = loop_.chunks.chunk_of(item);
  const traces::TileWork& work = tiles_[part.tile].work();
  const std::uint32_t* begin = &work.access_begin[work.nodes[part.node].first + part.first + item - part.begin];
  return std::span(work.accesses).subspan(begin[0], begin[1] - begin[0]);
}

void Srp::collect_lines(std::uint32_t item) {
  if (loads_.lines_of_item == item) return;
  loads_.lines_of_item = item;
  loads_.lines.clear();
  for (const traces::Access& access : accesses_of(item)) {
    const LineSet lines =
        lines_of_access(access, *frame_.layout, frame_.areas[static_cast<std::size_t>(Area::kSamples)]);
    for (std::uint32_t i = 0; i < lines.count; ++i) {
      if (std::ranges::find(loads_.lines, lines.line[i]) == loads_.lines.end()) loads_.lines.push_back(lines.line[i]);
    }
  }
}

// Functions of the launch scheduler.

void Srp::start_chunk(sim::Time now) {
  launch_.check_pending = false;
  launch_.is_blocked = false;
  for (const std::uint32_t tile : by_age_) {
    const std::uint32_t node = tiles_[tile].next_launch([&](std::uint32_t n) {
      if (has_ray_slots(tile, n)) return true;
      launch_.is_blocked = true;
      return false;
    });
    if (node != TileRun::kNone) return begin_chunk(now, tile, node);
  }
  if (!launch_.is_blocked) return;
  const bool rays_can_go =
      std::ranges::any_of(rays_.feeds, [&](const RayFeed& f) { return ray_ready_at(f) != sim::kNever; });
  // Borders imported by the oldest tile will arrive, because they belong to still older tiles. Borders imported by
  // younger tiles may depend on this tile.
  const bool data_come = transfers_.spills_done < transfers_.spills_started || transfers_.awaited > 0 ||
                         tiles_[by_age_.front()].is_awaiting_border();
  if (rays_.in_flight > 0 || rays_can_go || data_come) return;
  for (const std::uint32_t tile : by_age_) {
    const std::uint32_t node = tiles_[tile].next_launch([](std::uint32_t) { return true; });
    if (node != TileRun::kNone) return begin_chunk(now, tile, node);
  }
}

bool Srp::has_ray_slots(std::uint32_t tile, std::uint32_t node) const {
  const TileRun& run = tiles_[tile];
  const std::uint64_t rays = run.count_produced_rays(node, run.done_items(node), run.next_chunk_size(node));
  if (rays == 0) return true;
  const std::uint32_t wave = frame_.needs.wave_samples != 0 ? frame_.needs.wave_samples : frame_.needs.tile_samples;
  const bool first_rays_of_younger = tile != by_age_.front() && !run.depends_on_rays(node);
  return buffer_.free_slots() >= rays + (first_rays_of_younger ? wave : 0);
}

void Srp::begin_chunk(sim::Time now, std::uint32_t tile, std::uint32_t node) {
  const WorkNode& work = tiles_[tile].node(node);
  const KernelSchedule& kernel = frame_.kernels[work.kernel];
  launch_.is_blocked = false;
  loop_.chunks.clear();
  loads_.lines_of_item = kNoItem;
  add_chunk(tile, node);
  if (config_.merge) join_ready_launches(work);
  const std::uint32_t items = loop_.chunks.item_count(), working = loop_.chunks.non_idle_count();
  const bool conflicts = !frame_.ideal && !frame_.ideal_buffer;
  const std::uint64_t conflict_cycles = conflicts ? frame_.conflicts[work.kernel].stall_cycles(items) : 0;
  const sim::Time configured = clock_.edge_after(now, switch_to_kernel(work.kernel));
  loop_ = ArrayLoop{.active = true,
                    .kernel = work.kernel,
                    .chunks = std::move(loop_.chunks),
                    .loading = work.has_accesses ? working : 0,
                    .begin = now,
                    .without_rays = rays_.time_without_rays(now),
                    .configured = configured,
                    .start = clock_.edge_after(configured, conflict_cycles),
                    .ii = frame_.ideal ? 0 : kernel.ii,
                    .depth = frame_.ideal ? 1 : kernel.depth};
  stats_.add_loop(kernel, items, working);
  stats_.launches += loop_.chunks.size();
  if (loop_.chunks.size() > 1) stats_.merged += 1;
  buffer_.count_reads(std::uint64_t{items} * kernel.local_reads);
  buffer_.count_writes(std::uint64_t{items} * kernel.local_writes);
  buffer_.count_conflicts(conflict_cycles);
  kernel_use_[work.kernel].launches += 1;
  kernel_use_[work.kernel].items += items;
  kernel_use_[work.kernel].idle += items - working;
}

/// Switches the shader core's array to a kernel. Returns the cycles until the array can run the kernel.
std::uint64_t Srp::switch_to_kernel(traces::KernelId kernel) {
  if (std::exchange(launch_.kernel, kernel) == kernel || frame_.ideal) return 0;
  const std::uint32_t rows = frame_.kernels[kernel].ii;
  const bool resident = launch_.config_memory.select_kernel(kernel, config_.config_bytes(rows));
  stats_.add_switch(rows, resident);
  return config_.switch_cycles + (resident ? 0 : config_.load_cycles(rows));
}

/// Adds the next chunk of a launch to the array loop. Spills rays of the chunk that find no free ray slot to memory.
void Srp::add_chunk(std::uint32_t tile, std::uint32_t node) {
  TileRun& run = tiles_[tile];
  const std::uint32_t first = run.done_items(node), items = run.next_chunk_size(node);
  loop_.chunks.add({tile, node, first, items, run.non_idle_items(node, first, items)});
  const std::uint64_t spilled = buffer_.allocate_slots(run.count_produced_rays(node, first, items));
  for (const std::uint32_t batch : run.batches_of(node)) {
    if (first == 0 && run.node(batch).kind == WorkNode::Kind::kRays) rays_.feeds.push_back({tile, batch, 0, 0});
  }
  if (spilled == 0) return;
  // A spilled ray is written to memory and read back before it is sent; its hit is written and read back before it is
  // shaded.
  const auto bytes = static_cast<std::uint32_t>(2 * spilled * buffer_.slot_bytes());
  buffer_.count_reads(bytes / kAccessBytes);
  buffer_.count_writes(bytes / kAccessBytes);
  const Addr spill = frame_.areas[static_cast<std::size_t>(Area::kSpill)];
  transfers_.dma.push_back({spill, bytes, true, kSpillTag, Area::kSpill, 0, run.tile_tag()});
  transfers_.dma.push_back({spill, bytes, false, kSpillTag, Area::kSpill, 0, run.tile_tag()});
  transfers_.spills_started += 2;
  for (RayFeed& f : rays_.feeds) {
    if (f.tile == tile && run.producing_launch(f.batch) == node) f.after_spill = transfers_.spills_started;
  }
}

/// Adds chunks of other ready launches of the same kernel to the loop, oldest tile first. Limits: the maximum number of
/// items of a chunk, and the free ray slots.
void Srp::join_ready_launches(const WorkNode& work) {
  for (const std::uint32_t tile : by_age_) {
    const TileRun& run = tiles_[tile];
    const auto joins = [&](std::uint32_t n) {
      return run.node(n).kernel == work.kernel && run.node(n).has_accesses == work.has_accesses &&
             loop_.chunks.item_count() + run.next_chunk_size(n) <= config_.chunk &&
             loop_.chunks.find_chunk_of_launch(tile, n) == nullptr && has_ray_slots(tile, n);
    };
    for (std::uint32_t n = run.next_launch(joins); n != TileRun::kNone; n = run.next_launch(joins)) add_chunk(tile, n);
  }
}

// Functions that exchange rays and hits with the T&I unit.

sim::Time Srp::ray_ready_at(const RayFeed& feed) const {
  if (transfers_.spills_done < feed.after_spill) return sim::kNever;
  const TileRun& run = tiles_[feed.tile];
  const std::uint32_t launch = run.producing_launch(feed.batch);
  const std::uint32_t item = run.source_item(feed.batch, feed.next);
  if (item < run.done_items(launch)) return 0;
  const LoopChunk* part = loop_.active ? loop_.chunks.find_chunk_of_launch(feed.tile, launch) : nullptr;
  if (part == nullptr || item >= part->first + part->working) return sim::kNever;
  if (frame_.ideal && loop_.is_stalled()) return sim::kNever;
  const sim::Time leaves = loop_.item_end(clock_, part->begin + item - part->first);
  return leaves <= loop_.stalled_since ? leaves : sim::kNever;
}

inline bool Srp::feed_ray(sim::Time now) {
  if (rays_.feeds.empty() || now < rays_.next_at || !links_.rays_out.can_push(now)) return false;
  const auto feed = std::ranges::find_if(rays_.feeds, [&](const RayFeed& f) { return ray_ready_at(f) <= now; });
  if (feed == rays_.feeds.end()) return false;
  const TileRun& run = tiles_[feed->tile];
  const std::uint32_t ray = run.node(feed->batch).first + feed->next;
  const traces::TileWork& work = run.work();
  links_.rays_out.push(now, RayJob{work.walk.data() + work.ray_begin[ray], handle_of(feed->tile, ray), run.tile_tag(),
                                   work.ray_keys.empty() ? RayJob::kNoKey : work.ray_keys[ray]});
  buffer_.count_reads(sizeof(traces::Ray) / kAccessBytes);
  rays_.note_sent(now);
  stats_.rays += 1;
  if (frame_.observer != nullptr && feed->next == 0) {
    notify(*frame_.observer, BatchStarted{frame_.core, feed->tile, feed->batch, rays_.in_flight, now});
  }
  rays_.next_at = clock_.edge_at_or_after(now + frame_.ray_interval);
  if (++feed->next == run.node(feed->batch).items) rays_.feeds.erase(feed);
  return true;
}

inline void Srp::take_hit(sim::Time now) {
  if (arrivals_.hits > now) return;
  const std::uint32_t id = links_.hits_in.pop(now).id;
  buffer_.count_writes(sizeof(traces::Hit) / kAccessBytes);
  rays_.record_return_time(now);
  stats_.hits += 1;
  const std::uint32_t tile = tile_of_handle(id);
  const bool may_be_ready = tiles_[tile].finish_ray(index_of_handle(id));
  if (frame_.observer != nullptr) [[unlikely]]
    notify_batch_end(now, tile, index_of_handle(id));
  if (may_be_ready) start_transfers(tile);
  if (may_be_ready || rays_.in_flight == 0) launch_.check_pending = true;
}

/// Notifies the observer that a batch of rays has ended, if this hit is the batch's last one.
void Srp::notify_batch_end(sim::Time now, std::uint32_t tile, std::uint32_t ray) const {
  const TileRun& run = tiles_[tile];
  const std::uint32_t batch = run.batch_of(ray);
  if (!run.is_complete(batch)) return;
  notify(*frame_.observer, BatchEnded{frame_.core, tile, batch, &run.node(batch), rays_.in_flight, now});
}

// Functions that start and finish transfers and rasteriser jobs.

void Srp::start_transfers(std::uint32_t tile) {
  tiles_[tile].start_transfers([&](std::uint32_t n) {
    const WorkNode& node = tiles_[tile].node(n);
    if (node.kind != WorkNode::Kind::kTransfer) return queue_raster_job(tile, n);
    const Area area = area_of(node.region);
    const Addr base = frame_.areas[static_cast<std::size_t>(area)] + node.offset;
    const std::uint32_t cycles = area == Area::kPicture ? frame_.encode_cycles : 0;
    transfers_.dma.push_back(
        {base, node.items, node.to_memory, handle_of(tile, n), area, cycles, tiles_[tile].tile_tag()});
    const std::uint64_t accesses = (std::uint64_t{node.items} * std::max(cycles, 1U) + kAccessBytes - 1) / kAccessBytes;
    if (node.to_memory) {
      buffer_.count_reads(accesses);
    } else {
      buffer_.count_writes(accesses);
    }
    if (tiles_[tile].is_awaited(n)) transfers_.awaited += 1;
  });
}

inline void Srp::take_finished_transfer(sim::Time now) {
  if (arrivals_.transfers > now) return;
  const std::uint32_t tag = links_.dma_in.pop(now).tag;
  if (tag == kSpillTag) {
    transfers_.spills_done += 1;
    launch_.check_pending = true;
    return;
  }
  const std::uint32_t tile = tile_of_handle(tag), node = index_of_handle(tag);
  if (tiles_[tile].is_awaited(node)) transfers_.awaited -= 1;
  const WorkNode& moved = tiles_[tile].node(node);
  if (moved.to_memory && moved.border != WorkNode::kNone) {
    links_.tiles_out.push(now, TileDone{&tiles_[tile].work(), moved.border, tiles_[tile].tile_tag()});
  }
  finish_items(now, tile, node, tiles_[tile].node(node).items);
}

void Srp::queue_raster_job(std::uint32_t tile, std::uint32_t node) {
  transfers_.raster.push_back({&tiles_[tile].work(), node, handle_of(tile, node), tiles_[tile].tile_tag()});
  if (tiles_[tile].is_awaited(node)) transfers_.awaited += 1;
}

/// Sends waiting jobs to the rasteriser, and takes notifications of finished jobs from it.
void Srp::service_rasteriser_links(sim::Time now) {
  if (links_.raster_in->can_pop(now)) {
    const std::uint32_t tag = links_.raster_in->pop(now).tag;
    const std::uint32_t tile = tile_of_handle(tag), node = index_of_handle(tag);
    const traces::WorkNode& done = tiles_[tile].node(node);
    if (done.kind == traces::WorkNode::Kind::kRaster) {
      buffer_.count_writes((std::uint64_t{done.items} * frame_.plane_bytes + kAccessBytes - 1) / kAccessBytes);
    }
    if (tiles_[tile].is_awaited(node)) transfers_.awaited -= 1;
    finish_items(now, tile, node, done.items);
  }
  if (transfers_.raster.empty() || !links_.raster_out->can_push(now)) return;
  links_.raster_out->push(now, transfers_.raster.front());
  transfers_.raster.pop_front();
}

}  // namespace hw
