#include "hw_models/raster/raster_unit.h"

#include <algorithm>
#include <bit>

#include <fmt/format.h>

namespace hw {

void RasterFetch::add_triangle(const traces::RasterTriangle& triangle, std::uint32_t entry, TileTag tile) {
  l1_.set_slot_tile(static_cast<std::uint32_t>(entered_ % slots_.size()), tile);
  Slot& s = slot_of(entered_++);
  s = Slot{};
  s.triangle = &triangle;
  s.entry = entry;
}

void RasterFetch::add_lines(Slot& slot, Addr first_byte, std::uint32_t bytes) {
  for (const Addr line : {line_of(first_byte), line_of(first_byte + bytes - 1)}) {
    const auto end = slot.lines.begin() + slot.count;
    if (std::find(slot.lines.begin(), end, line) == end) slot.lines[slot.count++] = line;
  }
}

void RasterFetch::collect_lines(Stage stage, Slot& slot) {
  slot.listed = true;
  slot.count = slot.next = 0;
  if (stage == kList) {
    if (slot.entry != kBatch) add_lines(slot, memory_.entry_address(slot.entry), RasterMemory::kEntryBytes);
  } else if (stage == kIndices) {
    add_lines(slot, memory_.index_address(slot.triangle->number), RasterMemory::kIndexBytes);
  } else {
    collect_vertex_lines(slot);
  }
}

void RasterFetch::collect_vertex_lines(Slot& slot) {
  for (const std::uint32_t vertex : slot.triangle->vertices) {
    if (slot.entry != kBatch) {
      add_lines(slot, memory_.transformed_address(vertex), RasterMemory::kTransformedBytes);
    } else if (vertex_cache_.find_or_add(vertex)) {
      stats_.vertices_reused += 1;
    } else {
      slot.vertices[slot.missed++] = vertex;
      add_lines(slot, memory_.position_address(vertex), RasterMemory::kPositionBytes);
    }
  }
}

bool RasterFetch::advance_stage(Stage stage, std::uint32_t& lookups_done) {
  const std::uint64_t number = done_[stage];
  if (number == entered_ || (stage != kList && done_[stage - 1] <= number)) return false;
  Slot& s = slot_of(number);
  if (!s.listed) {
    if (s.pending != 0) return false;  // lines that the previous stage requested have not arrived
    collect_lines(stage, s);
  }
  if (s.next < s.count) {
    const auto slot_number = static_cast<std::uint32_t>(number % slots_.size());
    switch (l1_.access_line(s.lines[s.next], slot_number)) {
      case L1Cache::Result::kFull:
        return false;
      case L1Cache::Result::kMiss:
        s.pending += 1;
        stats_.l1_misses += 1;
        break;
      case L1Cache::Result::kHit:
        stats_.l1_hits += 1;
        break;
    }
    stats_.l1_accesses += 1;
    lookups_done += 1;
    s.next += 1;
  }
  if (s.next == s.count) {
    done_[stage] += 1;
    s.listed = false;
  }
  return true;
}

bool RasterFetch::look_up_lines() {
  std::uint32_t looked = 0;
  bool any = false;
  for (bool moved = true; moved && looked < lookups_;) {
    moved = advance_stage(kVertices, looked) || advance_stage(kIndices, looked) || advance_stage(kList, looked);
    any |= moved;
  }
  return any;
}

void RasterFetch::fill_line(Addr line) {
  stats_.l1_fills += 1;
  for (std::uint64_t waiting = l1_.fill_line(line).slots; waiting != 0; waiting &= waiting - 1) {
    slots_[static_cast<std::size_t>(std::countr_zero(waiting))].pending -= 1;
  }
}

std::string RasterFetch::state() const {
  return fmt::format("triangles in the window {}, lines on their way {}", entered_ - left_, l1_.outstanding_misses());
}

RasterUnit::RasterUnit(const RasterUnitConfig& config, const RasterMemory& memory, Links links, std::uint16_t client,
                       sim::Clock clock, bool ideal_l1)
    : config_(config),
      memory_(memory),
      clock_(clock),
      links_(links),
      fetch_(config, memory, client, ideal_l1, stats_),
      writes_(config.write_buffer, client),
      jobs_(config.jobs) {}

sim::Time RasterUnit::tick(sim::Time now) {
  if (links_.memory_in.can_pop(now)) fetch_.fill_line(links_.memory_in.pop(now).line);
  bool wrote = false;
  bool moved = finish_oldest_job(now);
  if (end_ == End::kWriting && job_at(ended_).is_batch()) wrote = write_lists();
  moved |= end_back_stage(now);
  begin_back_stage(now);
  moved |= end_front_stage(now);
  begin_back_stage(now);
  begin_front_stage(now);
  const bool looked = fetch_.look_up_lines();
  moved |= add_triangle_to_window();
  moved |= take_job(now);
  wrote |= send_line(now);
  moved |= looked || wrote;
  activity_.spend(now, clock_.period(), cycle_reason(now, wrote, looked),
                  cycle_reason(clock_.edge_after(now, 1), false, false));
  return next_wake(now, moved);
}

bool RasterUnit::take_job(sim::Time now) {
  if (taken_ - ended_ == jobs_.size() || !links_.jobs_in.can_pop(now)) return false;
  jobs_[taken_++ % jobs_.size()].job = links_.jobs_in.pop(now);
  return true;
}

bool RasterUnit::advance_cursor(Cursor& cursor) const {
  while (cursor.job < taken_ && cursor.triangle == job_at(cursor.job).triangle_count()) cursor = {cursor.job + 1, 0};
  return cursor.job < taken_;
}

bool RasterUnit::add_triangle_to_window() {
  if (!fetch_.has_room() || !advance_cursor(entering_)) return false;
  const Job& from = job_at(entering_.job);
  if (entering_.triangle == 0) run_ = run_entry_ = 0;
  std::uint32_t entry = RasterFetch::kBatch;
  if (!from.is_batch()) {
    while (run_entry_ == from.run_at(run_).entries) {
      run_ += 1;
      run_entry_ = 0;
    }
    entry = from.run_at(run_).first + run_entry_++;
    stats_.entries_read += 1;
  }
  fetch_.add_triangle(from.triangle_at(entering_.triangle++), entry, from.job.tile);
  return true;
}

void RasterUnit::begin_front_stage(sim::Time now) {
  constexpr std::uint32_t kLines = 4;  // maximum lines to which a triangle's vertices are written
  if (has_front_ || !fetch_.is_ready()) return;
  advance_cursor(setting_);
  const Job& of = job_at(setting_.job);
  if (of.is_batch() && !writes_.has_room(kLines)) return;
  std::uint64_t cycles = 0;
  if (of.is_batch()) {
    cycles = std::uint64_t{fetch_.missed_vertex_count()} * config_.vertex_interval;
    write_vertices();
  } else {
    cycles = config_.setup_interval * depth_buffer_parts_of(of);
    stats_.triangles_set_up += depth_buffer_parts_of(of);
  }
  fetch_.remove_oldest();
  has_front_ = true;
  front_until_ = clock_.edge_after(now, std::max<std::uint64_t>(1, cycles));
}

/// Queues the newly transformed vertices of the next triangle to be written to memory.
void RasterUnit::write_vertices() {
  const TileTag tile = job_at(setting_.job).job.tile;
  for (std::uint32_t i = 0; i < fetch_.missed_vertex_count(); ++i) {
    writes_.add_bytes(memory_.transformed_address(fetch_.missed_vertices()[i]), RasterMemory::kTransformedBytes, tile);
  }
  stats_.vertices_transformed += fetch_.missed_vertex_count();
}

bool RasterUnit::end_front_stage(sim::Time now) {
  if (!has_front_ || now < front_until_ || queued_ == config_.queue) return false;
  has_front_ = false;
  queued_ += 1;
  setting_.triangle += 1;
  return true;
}

void RasterUnit::begin_back_stage(sim::Time now) {
  // If the oldest job has no triangle left, the triangles in the queue belong to a later job.
  if (has_back_ || queued_ == 0 || finished_ == job_at(ended_).triangle_count()) return;
  const Job& of = job_at(ended_);
  const traces::RasterTriangle& triangle = of.triangle_at(finished_);
  const std::uint64_t cycles =
      of.is_batch() ? count_binning_cycles(triangle) : count_coverage_cycles(triangle, of.work());
  queued_ -= 1;
  has_back_ = true;
  back_until_ = clock_.edge_after(now, std::max<std::uint64_t>(1, cycles));
}

std::uint64_t RasterUnit::count_binning_cycles(const traces::RasterTriangle& triangle) {
  stats_.triangles += 1;
  stats_.triangles_culled += triangle.lists == 0;
  return std::uint64_t{triangle.lists} * config_.list_interval;
}

std::uint64_t RasterUnit::count_coverage_cycles(const traces::RasterTriangle& triangle,
                                                const traces::RasterWork& work) {
  const bool leaves_out = config_.hierarchical_z;
  const std::uint32_t quads = triangle.quads - (leaves_out ? triangle.hidden_quads : 0);
  const std::uint32_t hidden = leaves_out ? triangle.hidden_samples : 0;
  const std::uint64_t passes = (work.pixel_samples + config_.sub_samples - 1) / config_.sub_samples;
  stats_.blocks += triangle.blocks;
  stats_.blocks_hidden += leaves_out ? triangle.hidden_blocks : 0;
  stats_.quads += quads;
  stats_.quads_hidden += triangle.quads - quads;
  stats_.quad_passes += quads * passes;
  stats_.samples_covered += triangle.samples;
  stats_.samples_hidden += hidden;
  stats_.samples_passed += triangle.passed;
  stats_.samples_failed += triangle.samples - hidden - triangle.passed;
  return std::uint64_t{triangle.blocks} * config_.block_interval + quads * passes * config_.quad_interval;
}

bool RasterUnit::end_back_stage(sim::Time now) {
  if (!has_back_ || now < back_until_) return false;
  has_back_ = false;
  finished_ += 1;
  return true;
}

/// Finishes the rasteriser's oldest job after its last triangle. Writes the tile-list entries of a batch (geometry
/// pass) or the hits of a wave of samples, then notifies the core.
bool RasterUnit::finish_oldest_job(sim::Time now) {
  if (!has_jobs() || finished_ < job_at(ended_).triangle_count()) return false;
  const Job& of = job_at(ended_);
  if (end_ == End::kNot) {
    end_ = End::kWriting;
    out_run_ = out_entry_ = 0;
    if (of.is_batch() && of.work().runs == 0) end_batch_writes();
    const std::uint64_t bytes = std::uint64_t{of.node().items} * config_.plane_bytes;
    const std::uint64_t cycles =
        of.is_batch() ? 0 : (bytes + config_.plane_width.bytes - 1) / config_.plane_width.bytes;
    end_until_ = clock_.edge_after(now, cycles);
    return true;
  }
  if (end_ == End::kWriting) {
    const bool done = of.is_batch() ? out_run_ == of.work().runs && writes_.sent_lines() >= closed_ : now >= end_until_;
    if (!done) return false;
    end_ = End::kLeaving;
  }
  if (!links_.done_out.can_push(now)) return false;
  links_.done_out.push(now, RasterDone{of.job.tag});
  (of.is_batch() ? stats_.batches : stats_.waves) += 1;
  if (!of.is_batch()) stats_.samples_out += of.node().items;
  end_ = End::kNot;
  finished_ = 0;
  ended_ += 1;
  for (Cursor* const stage : {&entering_, &setting_}) {
    if (stage->job < ended_) *stage = {ended_, 0};
  }
  return true;
}

/// Queues up to one cache line of tile-list entries of the oldest batch to be written to memory.
bool RasterUnit::write_lists() {
  const Job& of = job_at(ended_);
  if (out_run_ == of.work().runs || !writes_.has_room(2)) return false;
  const traces::ListRun& run = of.run_at(out_run_);
  const Addr first = memory_.entry_address(run.first + out_entry_);
  const auto in_line = static_cast<std::uint32_t>((line_of(first) + kLineBytes - first) / RasterMemory::kEntryBytes);
  const std::uint32_t entries = std::min(in_line, run.entries - out_entry_);
  if (entries != 0) writes_.add_bytes(first, entries * RasterMemory::kEntryBytes, of.job.tile);
  stats_.entries_written += entries;
  out_entry_ += entries;
  if (out_entry_ == run.entries) {
    out_run_ += 1;
    out_entry_ = 0;
  }
  if (out_run_ == of.work().runs) end_batch_writes();
  return true;
}

void RasterUnit::end_batch_writes() {
  writes_.close_line();
  closed_ = writes_.closed_lines();
}

bool RasterUnit::send_line(sim::Time now) {
  if (fetch_.next_send_time(now, links_.memory_out) <= now) {
    fetch_.send_request(now, links_.memory_out);
    return false;
  }
  if (!writes_.send_line(now, links_.memory_out)) return false;
  stats_.writes += 1;
  return true;
}

RasterUnit::CycleReason RasterUnit::cycle_reason(sim::Time at, bool wrote, bool looked) const {
  if (!has_jobs()) return CycleReason::kIdle;
  if (end_ != End::kNot) {
    if (job_at(ended_).is_batch()) return wrote ? CycleReason::kListing : CycleReason::kPortFull;
    return at < end_until_ ? CycleReason::kWriting : CycleReason::kPortFull;
  }
  if (has_back_ && at < back_until_) return job_at(ended_).is_batch() ? CycleReason::kListing : CycleReason::kCovering;
  if (has_front_ && at < front_until_) {
    return job_at(setting_.job).is_batch() ? CycleReason::kTransforming : CycleReason::kSettingUp;
  }
  if (looked) return CycleReason::kFetching;
  return fetch_.is_ready() && !has_front_ ? CycleReason::kPortFull : CycleReason::kMemory;
}

sim::Time RasterUnit::next_wake(sim::Time now, bool moved) const {
  const sim::Time next = clock_.edge_after(now, 1);
  if (moved) return next;
  sim::Time at = std::max(next, links_.memory_in.pop_at());
  if (taken_ - ended_ < jobs_.size()) at = std::min(at, std::max(next, links_.jobs_in.pop_at()));
  if (has_front_ && now < front_until_) at = std::min(at, front_until_);
  if (has_back_) at = std::min(at, std::max(next, back_until_));
  if (end_ == End::kWriting && !job_at(ended_).is_batch()) at = std::min(at, std::max(next, end_until_));
  if (end_ == End::kLeaving) at = std::min(at, std::max(next, links_.done_out.push_at()));
  if (writes_.has_closed_line()) at = std::min(at, std::max(next, links_.memory_out.push_at()));
  return std::min(at, fetch_.next_send_time(next, links_.memory_out));
}

std::string RasterUnit::state() const {
  if (!has_jobs()) return "idle";
  const Job& of = job_at(ended_);
  return fmt::format("{} tile {}, triangles {}/{}, set up {}, jobs {}, {}", of.is_batch() ? "listing" : "covering",
                     of.job.work->tile, finished_, of.triangle_count(), queued_, taken_ - ended_, fetch_.state());
}

}  // namespace hw
