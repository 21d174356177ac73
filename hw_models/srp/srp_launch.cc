#include <algorithm>
#include <utility>

#include "hw_models/srp/srp.h"

namespace hw {

using traces::WorkNode;

bool Srp::fits(std::uint32_t tile, std::uint32_t node) const {
  const TileRun& run = tiles_[tile];
  const std::uint64_t rays = run.rays_made(node, run.done(node), run.chunk_items(node));
  if (rays == 0) return true;
  const std::uint32_t wave = frame_.needs.wave_samples != 0 ? frame_.needs.wave_samples : frame_.needs.tile_samples;
  const bool first_rays_of_younger = tile != by_age_.front() && !run.follows_rays(node);
  return buffer_.free() >= rays + (first_rays_of_younger ? wave : 0);
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
  if (!blocked_) return;
  const bool rays_can_go = std::ranges::any_of(feeds_, [&](const Feed& f) { return feed_at(f) != sim::kNever; });
  // The oldest tile's imports come, as they are of tiles that are older still. Those of younger tiles may be of this
  // one.
  const bool data_come =
      spills_done_ < spills_asked_ || transfers_awaited_ > 0 || tiles_[by_age_.front()].awaits_border();
  if (rays_out_ > 0 || rays_can_go || data_come) return;
  for (const std::uint32_t tile : by_age_) {
    const std::uint32_t node = tiles_[tile].next_launch([](std::uint32_t) { return true; });
    if (node != TileRun::kNone) return begin_chunk(now, tile, node);
  }
}

/// Cycles until the array can run the kernel.
std::uint64_t Srp::switch_to(traces::KernelId kernel) {
  if (std::exchange(configured_, kernel) == kernel || frame_.ideal) return 0;
  const std::uint32_t rows = frame_.kernels[kernel].ii;
  const bool resident = config_memory_.use(kernel, config_.config_bytes(rows));
  stats_.add_switch(rows, resident);
  return config_.switch_cycles + (resident ? 0 : config_.load_cycles(rows));
}

/// Puts a launch's next chunk into the loop. Rays for which there are no slots go out to memory and back.
void Srp::add_part(std::uint32_t tile, std::uint32_t node) {
  TileRun& run = tiles_[tile];
  const std::uint32_t first = run.done(node), items = run.chunk_items(node);
  run_.parts.add({tile, node, first, items, run.working(node, first, items)});
  const std::uint64_t spilled = buffer_.take(run.rays_made(node, first, items));
  for (const std::uint32_t batch : run.batches_of(node)) {
    if (first == 0 && run.node(batch).kind == WorkNode::Kind::kRays) feeds_.push_back({tile, batch, 0, 0});
  }
  if (spilled == 0) return;
  // Ray out and in again before it is issued, then its hit out and in again before it is shaded.
  const auto bytes = static_cast<std::uint32_t>(2 * spilled * buffer_.slot_bytes());
  buffer_.read(bytes / kAccess);
  buffer_.write(bytes / kAccess);
  const Addr spill = frame_.areas[static_cast<std::size_t>(Area::kSpill)];
  dma_.push_back({spill, bytes, true, kSpillTag, Area::kSpill, 0, run.owner()});
  dma_.push_back({spill, bytes, false, kSpillTag, Area::kSpill, 0, run.owner()});
  spills_asked_ += 2;
  for (Feed& f : feeds_) {
    if (f.tile == tile && run.producer(f.batch) == node) f.after_spill = spills_asked_;
  }
}

/// Puts into the loop what else waits for this kernel, oldest tile first, as far as a chunk's items and ray slots go.
void Srp::join_launches(const WorkNode& work) {
  for (const std::uint32_t tile : by_age_) {
    const TileRun& run = tiles_[tile];
    const auto joins = [&](std::uint32_t n) {
      return run.node(n).kernel == work.kernel && run.node(n).has_accesses == work.has_accesses &&
             run_.parts.items() + run.chunk_items(n) <= config_.chunk && run_.parts.find(tile, n) == nullptr &&
             fits(tile, n);
    };
    for (std::uint32_t n = run.next_launch(joins); n != TileRun::kNone; n = run.next_launch(joins)) add_part(tile, n);
  }
}

void Srp::begin_chunk(sim::Time now, std::uint32_t tile, std::uint32_t node) {
  const WorkNode& work = tiles_[tile].node(node);
  const KernelSchedule& kernel = frame_.kernels[work.kernel];
  blocked_ = false;
  run_.parts.clear();
  lines_of_ = kNoItem;
  add_part(tile, node);
  if (config_.merge) join_launches(work);
  const std::uint32_t items = run_.parts.items(), working = run_.parts.working();
  const bool conflicts = !frame_.ideal && !frame_.ideal_buffer;
  const std::uint64_t conflict_cycles = conflicts ? frame_.conflicts[work.kernel].of(items) : 0;
  const sim::Time configured = clock_.after(now, switch_to(work.kernel));
  run_ = Run{.active = true,
             .kernel = work.kernel,
             .parts = std::move(run_.parts),
             .loading = work.has_accesses ? working : 0,
             .begin = now,
             .without_rays = time_without_rays(now),
             .configured = configured,
             .start = clock_.after(configured, conflict_cycles),
             .ii = frame_.ideal ? 0 : kernel.ii,
             .depth = frame_.ideal ? 1 : kernel.depth};
  stats_.add(kernel, items, working);
  stats_.launches += run_.parts.size();
  if (run_.parts.size() > 1) stats_.merged += 1;
  buffer_.read(std::uint64_t{items} * kernel.local_reads);
  buffer_.write(std::uint64_t{items} * kernel.local_writes);
  buffer_.conflict(conflict_cycles);
  kernel_use_[work.kernel].launches += 1;
  kernel_use_[work.kernel].items += items;
  kernel_use_[work.kernel].idle += items - working;
}

/// Shares out a loop's cycles among its tiles by their items, whole cycles that add up.
void Srp::charge_tiles(std::uint64_t cycles) {
  std::uint64_t items = 0, charged = 0;
  for (const LoopPart& part : run_.parts) {
    items += part.items;
    const std::uint64_t until = cycles * items / run_.parts.items();
    frame_.book->of(tiles_[part.tile].owner()).srp_cycles += until - charged;
    charged = until;
  }
}

void Srp::show_loop(sim::Time now, std::uint64_t cycles) const {
  frame_.observer->loop_ends(frame_.core, {.kernel = run_.kernel,
                                           .begin = run_.begin,
                                           .configured = run_.configured,
                                           .start = run_.start,
                                           .end = now,
                                           .stalled = run_.stall_time,
                                           .cycles = cycles,
                                           .items = run_.parts.items(),
                                           .launches = static_cast<std::uint32_t>(run_.parts.size()),
                                           .tile = tiles_[run_.parts.begin()->tile].owner()});
}

/// The hit may have been the last of its batch.
void Srp::show_hit(sim::Time now, std::uint32_t tile, std::uint32_t ray) const {
  const TileRun& run = tiles_[tile];
  const std::uint32_t batch = run.batch_of(ray);
  if (run.complete(batch)) frame_.observer->batch_ends(frame_.core, tile, batch, run.node(batch), rays_out_, now);
}

}  // namespace hw
