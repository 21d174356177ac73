#include "hw_models/tni/ist.h"

#include <algorithm>
#include <bit>
#include <cassert>

#include <fmt/format.h>

#include "traces/walk.h"

namespace hw {

using traces::ExitPhase;

namespace {

constexpr std::uint64_t bit(std::uint32_t slot) { return std::uint64_t{1} << slot; }
constexpr Addr line_of(Addr a) { return a & ~Addr{63}; }

}  // namespace

Ist::Ist(const IstConfig& config, const TrianglesInMemory& triangles, Links links, std::uint16_t port, sim::Clock clock)
    : config_(config),
      clock_(clock),
      triangles_(triangles),
      links_(std::move(links)),
      l1_(config.l1, port),
      slots_(config.leaves),
      pipe_(clock),
      free_(config.leaves == 64 ? ~std::uint64_t{0} : bit(config.leaves) - 1) {}

sim::Time Ist::tick(sim::Time now) {
  pipe_.advance(now);
  answering_ |= pipe_.take()[0];
  take_line(now);
  take_leaf(now);
  const bool tried = ready_ != 0;
  const Why tested = tried ? issue() : Why::kStarved;
  answer(now);
  l1_.send(now, links_.memory_out);
  const Why then = waiting();
  activity_.spend(now, clock_.period(), tried ? tested : then, then);
  return next_wake(now);
}

void Ist::take_line(sim::Time now) {
  if (!links_.memory_in.can_pop(now)) return;
  const std::uint64_t waited = l1_.fill(links_.memory_in.pop(now).line);
  stats_.l1_fills += 1;
  missing_ &= ~waited;
  served_ |= waited;
  ready_ |= waited | no_mshr_;
  no_mshr_ = 0;
}

void Ist::take_leaf(sim::Time now) {
  if (free_ == 0) return;
  const auto sources = static_cast<std::uint32_t>(links_.leaves_in.size());
  for (std::uint32_t k = 0; k < sources; ++k) {
    const std::uint32_t trv = (source_turn_ + k) % sources;
    if (!links_.leaves_in[trv]->can_pop(now)) continue;
    source_turn_ = (trv + 1) % sources;
    const auto index = static_cast<std::uint32_t>(std::countr_zero(free_));
    free_ &= ~bit(index);
    occupied_ |= bit(index);
    ready_ |= bit(index);
    slots_[index] = Slot{links_.leaves_in[trv]->pop(now), trv, 0, false, 0};
    stats_.leaves_in += 1;
    return;
  }
}

Ist::Why Ist::issue() {
  const std::uint32_t index = pick(ready_, turn_);
  turn_ = (index + 1) % 64;
  ready_ &= ~bit(index);
  Slot& slot = slots_[index];
  const Addr begin = triangles_.base + Addr{slot.job.first + slot.tested} * triangles_.bytes;
  const Addr last_line = line_of(begin + triangles_.bytes - 1);
  const Addr line = slot.second_line ? last_line : line_of(begin);
  stats_.l1_accesses += 1;
  const bool served = (served_ & bit(index)) != 0;
  served_ &= ~bit(index);
  switch (served ? L1Cache::Result::kHit : l1_.access(line, index)) {
    case L1Cache::Result::kHit:
      stats_.l1_hits += 1;
      read(slot, index, line == last_line);
      return Why::kTesting;
    case L1Cache::Result::kMiss:
      stats_.l1_misses += 1;
      missing_ |= bit(index);
      return Why::kL1Miss;
    case L1Cache::Result::kFull:
      break;
  }
  stats_.l1_misses += 1;
  stats_.mshr_full += 1;
  no_mshr_ |= bit(index);
  return Why::kMshrFull;
}

void Ist::read(Slot& slot, std::uint32_t index, bool last_line) {
  if (!last_line) {
    slot.second_line = true;
    ready_ |= bit(index);
    return;
  }
  const ExitPhase phase = traces::phase_of(slot.job.phases, slot.tested);
  stats_.tests += 1;
  std::uint32_t stage = config_.distance_stage;
  if (phase != ExitPhase::kDistance) {
    stats_.edge_tests += 1;
    stage = config_.barycentric_stage;
  }
  if (phase == ExitPhase::kHit) {
    stats_.hits += 1;
    stage = config_.latency;
  }
  slot.known_at = std::max(slot.known_at, pipe_.cycle() + config_.l1.hit_cycles + stage);
  slot.tested += 1;
  slot.second_line = false;
  if (slot.tested < slot.job.count) {
    ready_ |= bit(index);
  } else {
    pipe_.put(0, index, slot.known_at - pipe_.cycle());
  }
}

void Ist::answer(sim::Time now) {
  if (answering_ == 0) return;
  const std::uint32_t index = pick(answering_, answer_turn_);
  const Slot& slot = slots_[index];
  sim::Link<LeafDone>& out = *links_.leaves_out[slot.trv];
  assert(out.can_push(now) && "the ray's slot is its reserved return space");
  answer_turn_ = (index + 1) % 64;
  answering_ &= ~bit(index);
  occupied_ &= ~bit(index);
  free_ |= bit(index);
  out.push(now, LeafDone{slot.job.slot});
  stats_.leaves_out += 1;
}

Ist::Why Ist::waiting() const {
  if (occupied_ == 0) return Why::kStarved;
  if (answering_ != 0) return Why::kOutputFull;
  if (no_mshr_ != 0) return Why::kMshrFull;
  if (missing_ != 0) return Why::kL1Miss;
  return Why::kPipe;
}

sim::Time Ist::next_wake(sim::Time now) const {
  const sim::Time next = clock_.after(now, 1);
  if ((ready_ | answering_) != 0) return next;
  sim::Time at = pipe_.next();
  if (free_ != 0) {
    for (const sim::Link<LeafJob>* link : links_.leaves_in) at = std::min(at, std::max(next, link->pop_at()));
  }
  at = std::min(at, std::max(next, links_.memory_in.pop_at()));
  return std::min(at, l1_.send_at(next, links_.memory_out));
}

std::string Ist::state() const {
  return fmt::format("leaves {}: ready {}, missing {}, no mshr {}, answering {}", std::popcount(occupied_),
                     std::popcount(ready_), std::popcount(missing_), std::popcount(no_mshr_),
                     std::popcount(answering_));
}

}  // namespace hw
