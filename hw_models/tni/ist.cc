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

Ist::Ist(const IstConfig& config, const TniMode& mode, const TrianglesInMemory& triangles, Links links,
         std::uint16_t port, sim::Clock clock)
    : config_(config),
      clock_(clock),
      triangles_(triangles),
      unbounded_(mode.unbounded),
      links_(std::move(links)),
      fetch_(config.l1, mode, port, stats_),
      slots_(config.leaves),
      pipe_(clock, config.l1.hit_cycles + config.latency),
      free_(config.leaves == 64 ? ~std::uint64_t{0} : bit(config.leaves) - 1) {}

sim::Time Ist::tick(sim::Time now) {
  const auto as_often_as_may_be = [&](auto&& step) {
    while (step() && unbounded_) {
    }
  };
  pipe_.advance(now);
  if (pipe_.due()) {
    const Wheel<kPipes>::Masks out = pipe_.take();
    answering_ |= out[kToAnswer];
    fetch_.enter(out[kToFetch]);
  }
  as_often_as_may_be([&] { return take_line(now); });
  as_often_as_may_be([&] { return take_leaf(now); });
  const bool tried = fetch_.able() != 0;
  const Why tested = tried ? issue() : Why::kStarved;
  as_often_as_may_be([&] { return answer(now); });
  fetch_.send(now, links_.memory_out);
  const sim::Time wake = next_wake(now);
  const Why then = tried && wake == clock_.after(now, 1) ? tested : waiting();
  activity_.spend(now, clock_.period(), tried ? tested : then, then);
  return wake;
}

bool Ist::take_line(sim::Time now) {
  if (!links_.memory_in.can_pop(now)) return false;
  fetch_.fill(links_.memory_in.pop(now).line, pipe_.cycle());
  return true;
}

bool Ist::take_leaf(sim::Time now) {
  if (free_ == 0) return false;
  const auto sources = static_cast<std::uint32_t>(links_.leaves_in.size());
  for (std::uint32_t k = 0; k < sources; ++k) {
    const std::uint32_t trv = (source_turn_ + k) % sources;
    if (!links_.leaves_in[trv]->can_pop(now)) continue;
    source_turn_ = (trv + 1) % sources;
    const auto index = static_cast<std::uint32_t>(std::countr_zero(free_));
    free_ &= ~bit(index);
    occupied_ |= bit(index);
    fetch_.enter(bit(index));
    slots_[index] = Slot{links_.leaves_in[trv]->pop(now), trv, 0, false, 0};
    fetch_.look_ahead(line_of(triangles_.base + Addr{slots_[index].job.first} * triangles_.bytes));
    stats_.leaves_in += 1;
    return true;
  }
  return false;
}

Ist::Why Ist::issue() {
  Why why = issue_one();
  while (unbounded_ && fetch_.able() != 0) {
    if (issue_one() == Why::kTesting) why = Why::kTesting;
  }
  return why;
}

Ist::Why Ist::issue_one() {
  const std::uint32_t index = pick(fetch_.able(), turn_);
  turn_ = (index + 1) % 64;
  Slot& slot = slots_[index];
  const Addr begin = triangles_.base + Addr{slot.job.first + slot.tested} * triangles_.bytes;
  const Addr last_line = line_of(begin + triangles_.bytes - 1);
  const Addr line = slot.second_line ? last_line : line_of(begin);
  const FetchStage::Result result = fetch_.read(index, line, pipe_.cycle());
  if (result == FetchStage::Result::kRead) {
    read(slot, index, line == last_line);
    return Why::kTesting;
  }
  if (fetch_.bypasses()) {
    stats_.bypass_passes += 1;
    pipe_.put(kToFetch, index, config_.l1.hit_cycles + config_.latency);
  }
  switch (result) {
    case FetchStage::Result::kNoRegister:
      return Why::kMshrFull;
    case FetchStage::Result::kTableFull:
      return Why::kRauFull;
    default:
      return Why::kL1Miss;
  }
}

void Ist::read(Slot& slot, std::uint32_t index, bool last_line) {
  if (!last_line) {
    slot.second_line = true;
    fetch_.enter(bit(index));
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
    fetch_.enter(bit(index));
  } else {
    pipe_.put(kToAnswer, index, slot.known_at - pipe_.cycle());
  }
}

bool Ist::answer(sim::Time now) {
  if (answering_ == 0) return false;
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
  return true;
}

Ist::Why Ist::waiting() const {
  if (occupied_ == 0) return Why::kStarved;
  if (answering_ != 0) return Why::kOutputFull;
  return FetchStage::reason(fetch_.waits_for(), Why::kPipe);
}

sim::Time Ist::next_wake(sim::Time now) const {
  const sim::Time next = clock_.after(now, 1);
  if ((fetch_.able() | answering_) != 0) return next;
  sim::Time at = pipe_.next();
  if (free_ != 0) {
    for (const sim::Link<LeafJob>* link : links_.leaves_in) at = std::min(at, std::max(next, link->pop_at()));
  }
  at = std::min(at, std::max(next, links_.memory_in.pop_at()));
  return std::min(at, fetch_.send_at(next, links_.memory_out));
}

std::string Ist::state() const {
  return fmt::format("leaves {}: ready {}, missing {}, no mshr {}, answering {}", std::popcount(occupied_),
                     std::popcount(fetch_.ready()), std::popcount(fetch_.missing()),
                     std::popcount(fetch_.no_register()), std::popcount(answering_));
}

}  // namespace hw
