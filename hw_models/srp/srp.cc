#include "hw_models/srp/srp.h"

#include <algorithm>
#include <cassert>

#include <fmt/format.h>

namespace hw {

using traces::WorkNode;

Srp::Srp(const SrpConfig& config, const TileBufferConfig& buffer, const Frame& frame, Links links, std::uint16_t port,
         sim::Clock clock)
    : config_(config),
      clock_(clock),
      frame_(frame),
      links_(links),
      buffer_(buffer, frame.needs, clock, frame.ideal_buffer),
      cache_(config.data_cache, port, frame.ideal_cache),
      tiles_(tiles_in_flight(buffer, frame.needs, frame.ideal_buffer).most()),
      lines_missing_(kMostLoadCycles),
      config_memory_(config.config_memory.bytes, frame.kernels.size()),
      kernel_use_(frame.kernels.size()) {
  links_.tiles_in.shows(&arrivals_.tiles);
  links_.hits_in.shows(&arrivals_.hits);
  links_.memory_in.shows(&arrivals_.lines);
  links_.dma_in.shows(&arrivals_.transfers);
  feeds_.reserve(64);
  run_.parts.reserve(64);
  item_lines_.reserve(64);
}

sim::Time Srp::tick(sim::Time now) {
  if (arrivals_.tiles <= now) take_tile(now);
  take_hit(now);
  fill(now);
  take_dma(now);
  if (links_.raster_out != nullptr) meet_rasteriser(now);
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
inline void Srp::account(sim::Time now) {
  const std::uint64_t cycles = clock_.cycles(now - accounted_);
  if (fed_) stats_.fed += cycles;
  if (fed_ && !busy_) stats_.awaited += cycles;
  accounted_ = now;
  fed_ = rays_out_ > 0;
  busy_ = run_.active;
}

void Srp::finish(sim::Time end) {
  if (end > accounted_) account(end);
  activity_.finish(end);
  buffer_.finish(end);
}

void Srp::take_tile(sim::Time now) {
  if (!has_room(links_.tiles_in.front())) return;
  const TileJob job = links_.tiles_in.pop(now);
  std::uint32_t tile = tile_of(job);
  look_ = true;
  if (tile != tiles_.size()) {
    tiles_[tile].borders_missing(job.missing);
    return start_transfers(tile);
  }
  tile = static_cast<std::uint32_t>(std::ranges::find_if_not(tiles_, &TileRun::active) - tiles_.begin());
  tiles_[tile].begin(*job.work, config_.chunk, job.missing, job.owner);
  if (by_age_.empty()) buffer_.in_use(now, true);
  by_age_.push_back(tile);
  stats_.tiles += 1;
  if (frame_.observer != nullptr) frame_.observer->tile_begins(frame_.core, tile, job.owner, now);
  start_transfers(tile);
}

std::uint32_t Srp::tile_of(const TileJob& job) const {
  const auto tile = std::ranges::find_if(by_age_, [&](std::uint32_t t) { return &tiles_[t].work() == job.work; });
  return tile == by_age_.end() ? static_cast<std::uint32_t>(tiles_.size()) : *tile;
}

inline void Srp::take_hit(sim::Time now) {
  if (arrivals_.hits > now) return;
  const std::uint32_t id = links_.hits_in.pop(now).id;
  buffer_.write(sizeof(traces::Hit) / kAccess);
  if (--rays_out_ == 0) empty_since_ = now;
  stats_.hits += 1;
  const std::uint32_t tile = tile_of_handle(id);
  const bool news = tiles_[tile].finish_ray(index_of_handle(id));
  if (frame_.observer != nullptr) [[unlikely]]
    show_hit(now, tile, index_of_handle(id));
  if (news) start_transfers(tile);
  if (news || rays_out_ == 0) look_ = true;
}

inline void Srp::take_dma(sim::Time now) {
  if (arrivals_.transfers > now) return;
  const std::uint32_t tag = links_.dma_in.pop(now).tag;
  if (tag == kSpillTag) {
    spills_done_ += 1;
    look_ = true;
    return;
  }
  const std::uint32_t tile = tile_of_handle(tag), node = index_of_handle(tag);
  if (tiles_[tile].is_awaited(node)) transfers_awaited_ -= 1;
  const WorkNode& moved = tiles_[tile].node(node);
  if (moved.to_memory && moved.border != WorkNode::kNone) {
    links_.tiles_out.push(now, TileDone{&tiles_[tile].work(), moved.border, tiles_[tile].owner()});
  }
  finish_items(now, tile, node, tiles_[tile].node(node).items);
}

inline void Srp::run_array(sim::Time now) {
  if (run_.active && now >= run_.start) {
    const bool flowing = frame_.ideal ? load_all(now) : loads_in_time(now) && issue_loads(now);
    if (flowing && run_.next_item == run_.loading && loads_.empty() && now >= leaves_at(run_.parts.items() - 1)) {
      finish_chunk(now);
    }
  }
  if (!run_.active && look_) start_chunk(now);
}

void Srp::finish_chunk(sim::Time now) {
  KernelUse& use = kernel_use_[run_.kernel];
  const std::uint64_t cycles = clock_.cycles(now - run_.begin);
  use.cycles += cycles;
  use.starved += clock_.cycles(time_without_rays(now) - run_.without_rays);
  if (frame_.book != nullptr) charge_tiles(cycles);
  if (frame_.observer != nullptr) show_loop(now, cycles);
  run_.active = false;
  for (const LoopPart& part : run_.parts) finish_items(now, part.tile, part.node, part.items);
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
    if (node.kind != WorkNode::Kind::kTransfer) return start_raster(tile, n);
    const Area area = area_of(node.region);
    const Addr base = frame_.areas[static_cast<std::size_t>(area)] + node.offset;
    const std::uint32_t cycles = area == Area::kPicture ? frame_.encode_cycles : 0;
    dma_.push_back({base, node.items, node.to_memory, handle_of(tile, n), area, cycles, tiles_[tile].owner()});
    const std::uint64_t accesses = (std::uint64_t{node.items} * std::max(cycles, 1U) + kAccess - 1) / kAccess;
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
  assert(links_.tiles_out.can_push(now) && "room for all that tiles in flight have to say");
  links_.tiles_out.push(now, TileDone{&tiles_[tile].work(), WorkNode::kNone, tiles_[tile].owner()});
  if (frame_.observer != nullptr) frame_.observer->tile_ends(frame_.core, tile, now);
  tiles_[tile].end();
  std::erase(by_age_, tile);
  if (by_age_.empty()) buffer_.in_use(now, false);
  look_ = true;
}

sim::Time Srp::feed_at(const Feed& feed) const {
  if (spills_done_ < feed.after_spill) return sim::kNever;
  const TileRun& run = tiles_[feed.tile];
  const std::uint32_t launch = run.producer(feed.batch);
  const std::uint32_t item = run.source(feed.batch, feed.next);
  if (item < run.done(launch)) return 0;
  const LoopPart* part = run_.active ? run_.parts.find(feed.tile, launch) : nullptr;
  if (part == nullptr || item >= part->first + part->working) return sim::kNever;
  if (frame_.ideal && run_.stalled_since != sim::kNever) return sim::kNever;
  const sim::Time leaves = leaves_at(part->begin + item - part->first);
  return leaves <= run_.stalled_since ? leaves : sim::kNever;
}

inline bool Srp::feed_ray(sim::Time now) {
  if (feeds_.empty() || now < feed_free_at_ || !links_.rays_out.can_push(now)) return false;
  const auto feed = std::ranges::find_if(feeds_, [&](const Feed& f) { return feed_at(f) <= now; });
  if (feed == feeds_.end()) return false;
  const TileRun& run = tiles_[feed->tile];
  const std::uint32_t ray = run.node(feed->batch).first + feed->next;
  const traces::TileWork& work = run.work();
  links_.rays_out.push(now, RayJob{work.walk.data() + work.ray_begin[ray], handle_of(feed->tile, ray), run.owner()});
  buffer_.read(sizeof(traces::Ray) / kAccess);
  without_rays_ = time_without_rays(now);
  rays_out_ += 1;
  stats_.rays += 1;
  if (frame_.observer != nullptr && feed->next == 0) {
    frame_.observer->batch_begins(frame_.core, feed->tile, feed->batch, rays_out_, now);
  }
  feed_free_at_ = clock_.edge_at_or_after(now + frame_.ray_interval);
  if (++feed->next == run.node(feed->batch).items) feeds_.erase(feed);
  return true;
}

inline Srp::CycleReason Srp::why(sim::Time now) const {
  if (run_.active) {
    if (now < run_.configured) return CycleReason::kSwitching;
    if (now < run_.start) return CycleReason::kBanks;
    return run_.stalled_since == sim::kNever ? CycleReason::kRunning : CycleReason::kCacheMiss;
  }
  if (by_age_.empty()) return CycleReason::kStarved;
  if (blocked_) return CycleReason::kNoSlots;
  const bool moves = rays_out_ > 0 || !feeds_.empty() || transfers_awaited_ > 0;
  const bool borders =
      !moves && std::ranges::any_of(by_age_, [&](std::uint32_t t) { return tiles_[t].awaits_border(); });
  return borders ? CycleReason::kBorders : CycleReason::kWaiting;
}

inline sim::Time Srp::next_wake(sim::Time now) const {
  const sim::Time next = clock_.after(now, 1);
  if (!run_.active && look_) return next;
  sim::Time at = sim::kNever;
  if (run_.active && now < run_.start) {
    at = now < run_.configured ? run_.configured : run_.start;
  } else if (run_.active && run_.stalled_since == sim::kNever) {
    const sim::Time origin = run_.start + run_.stall_time;
    at = leaves_at(run_.parts.items() - 1);
    if (run_.next_item < run_.loading) at = origin + sim::Time{run_.next_item} * run_.ii * clock_.period();
    if (!loads_.empty()) at = std::min(at, origin + loads_.front().needed);
    at = std::max(at, next);
  }
  if (!feeds_.empty()) {
    const sim::Time open = std::max({next, feed_free_at_, links_.rays_out.push_at()});
    for (auto f = feeds_.begin(); f != feeds_.end() && open < at; ++f) at = std::min(at, std::max(open, feed_at(*f)));
  }
  if (!dma_.empty()) at = std::min(at, std::max(next, links_.dma_out.push_at()));
  if (arrivals_.tiles != sim::kNever && has_room(links_.tiles_in.front())) {
    at = std::min(at, std::max(next, arrivals_.tiles));
  }
  at = std::min(at, std::max(next, std::min({arrivals_.hits, arrivals_.lines, arrivals_.transfers})));
  if (links_.raster_out != nullptr) {
    at = std::min(at, std::max(next, links_.raster_in->pop_at()));
    if (!raster_.empty()) at = std::min(at, std::max(next, links_.raster_out->push_at()));
  }
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
                     run_.active ? (run_.stalled_since == sim::kNever ? "running" : "stalled") : "array idle",
                     rays_out_, buffer_.used(), buffer_.slots(), feeds_.size(), dma_.size(), tiles);
}

}  // namespace hw
