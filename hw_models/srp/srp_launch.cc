#include <algorithm>

#include "hw_models/srp/srp.h"

namespace hw {

using traces::WorkNode;

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

}  // namespace hw
