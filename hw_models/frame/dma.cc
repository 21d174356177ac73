#include "hw_models/frame/dma.h"

#include <algorithm>

#include <fmt/format.h>

namespace hw {

sim::Time Dma::tick(sim::Time now) {
  if (links_.memory_in.can_pop(now)) {
    links_.memory_in.pop(now);
    replies_left_ -= 1;
  }
  if (!active_ && links_.jobs_in.can_pop(now)) {
    job_ = links_.jobs_in.pop(now);
    active_ = true;
    begun_at_ = now;
    next_line_ = line_of(job_.base);
    lines_left_ = static_cast<std::uint32_t>((round_up_to_lines(job_.base + job_.bytes) - next_line_) / kLineBytes);
    replies_left_ = job_.write ? 0 : lines_left_;
    encoded_at_ = clock_.edge_after(now, job_.encode_cycles == 0 ? 0 : job_.encode_cycles - 1);
  }
  const bool moved = active_ && move_line(now);
  if (active_ && lines_left_ == 0 && replies_left_ == 0 && links_.done_out.can_push(now)) {
    links_.done_out.push(now, DmaDone{job_.tag});
    if (links_.observer != nullptr) {
      notify(*links_.observer,
             TransferEnded{links_.core, job_.tile, job_.area, job_.write, job_.base, job_.bytes, begun_at_, now});
    }
    active_ = false;
    stats_.jobs += 1;
  }
  const auto reason = [&](sim::Time at) {
    if (!active_) return CycleReason::kIdle;
    return is_encoding(at) ? CycleReason::kEncoding : CycleReason::kWaiting;
  };
  activity_.spend(now, clock_.period(), moved ? CycleReason::kMoving : reason(now), reason(clock_.edge_after(now, 1)));
  return next_wake(now);
}

bool Dma::move_line(sim::Time now) {
  if (lines_left_ == 0 || is_encoding(now) || !links_.memory_out.can_push(now)) return false;
  links_.memory_out.push(now, MemRequest{next_line_, client_, 0, job_.write, kWholeLine, job_.tile});
  next_line_ += kLineBytes;
  lines_left_ -= 1;
  encoded_at_ = clock_.edge_after(now, job_.encode_cycles);
  if (job_.encode_cycles != 0) stats_.pixels_encoded += kLineBytes / traces::kPixelBytes;
  Stats::Lines& lines = stats_.lines[static_cast<std::size_t>(job_.area)];
  (job_.write ? stats_.lines_written : stats_.lines_read) += 1;
  (job_.write ? lines.written : lines.read) += 1;
  return true;
}

sim::Time Dma::next_wake(sim::Time now) const {
  const sim::Time next = clock_.edge_after(now, 1);
  sim::Time at = std::max(next, links_.memory_in.pop_at());
  if (!active_) {
    at = std::min(at, std::max(next, links_.jobs_in.pop_at()));
  } else if (lines_left_ > 0) {
    at = std::min(at, is_encoding(next) ? encoded_at_ : std::max(next, links_.memory_out.push_at()));
  } else if (replies_left_ == 0) {
    at = std::min(at, std::max(next, links_.done_out.push_at()));
  }
  return at;
}

std::string Dma::state() const {
  if (!active_) return "idle";
  return fmt::format("{} {} bytes, lines to ask for {}, replies to come {}", job_.write ? "writing" : "reading",
                     job_.bytes, lines_left_, replies_left_);
}

}  // namespace hw
