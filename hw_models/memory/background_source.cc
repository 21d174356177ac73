#include "hw_models/memory/background_source.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "sim/hash.h"

namespace hw {
namespace {

/// Returns the femtoseconds between two lines of background traffic of one DRAM channel.
double interval_of(const BackgroundConfig& config, const BackgroundSource::ChannelMapping& place) {
  const double lines = static_cast<double>(place.line_bytes) * place.channels;
  return lines / config.rate * sim::kFemtosecondsPerNanosecond;  // a GB/s is a byte per nanosecond
}

}  // namespace

BackgroundSource::BackgroundSource(const BackgroundConfig& config, const ChannelMapping& place, Links links,
                                   sim::Clock clock)
    : config_(config), place_(place), links_(links), clock_(clock), interval_(interval_of(config, place)) {}

/// Returns the first clock edge at which the next line of background traffic is due.
sim::Time BackgroundSource::next_due_time() const {
  return clock_.edge_at_or_after(static_cast<sim::Time>(std::llround(interval_ * static_cast<double>(sent_))));
}

MemRequest BackgroundSource::next_request() const {
  const std::uint64_t half = std::max<std::uint64_t>(1, place_.lines / 2);
  const std::uint64_t drawn = sim::hash(place_.channel, sent_);
  const std::uint64_t line = half + (config_.pattern == BackgroundPattern::kRandom ? drawn : sent_) % half;
  const std::uint64_t byte = line * place_.line_bytes;
  MemRequest request;
  request.line = (byte / place_.granule * place_.channels + place_.channel) * place_.granule + byte % place_.granule;
  const auto share = static_cast<double>(sim::hash(drawn, 1) >> 11) / static_cast<double>(std::uint64_t{1} << 53);
  request.write = share < config_.writes;
  return request;
}

sim::Time BackgroundSource::tick(sim::Time now) {
  if (links_.flush_in.can_pop(now)) {
    links_.flush_in.pop(now);
    stopped_ = true;
  }
  if (links_.memory_in.can_pop(now)) {
    links_.memory_in.pop(now);
    outstanding_ -= 1;
  }
  const sim::Time next = now + clock_.period();
  sim::Time wake = std::min(links_.flush_in.pop_at(), links_.memory_in.pop_at());
  CycleReason why = CycleReason::kStopped, then = why;
  if (!stopped_ && next_due_time() > now) {
    why = then = CycleReason::kPaced;
    wake = std::min(wake, next_due_time());
  } else if (!stopped_ && !links_.memory_out.can_push(now)) {
    why = then = CycleReason::kBlocked;
    wake = std::min(wake, links_.memory_out.push_at());
  } else if (!stopped_) {
    const MemRequest request = next_request();
    links_.memory_out.push(now, request);
    sent_ += 1;
    outstanding_ += request.write ? 0 : 1;
    (request.write ? stats_.writes : stats_.reads) += 1;
    why = CycleReason::kSending;
    then = CycleReason::kPaced;
    wake = std::min(wake, std::max(next, next_due_time()));
  }
  activity_.spend(now, clock_.period(), why, then);
  return std::max(wake, next);
}

std::string BackgroundSource::state() const {
  return fmt::format("{} lines sent, {} in flight{}", sent_, outstanding_, stopped_ ? ", stopped" : "");
}

}  // namespace hw
