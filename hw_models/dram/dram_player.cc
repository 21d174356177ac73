#include "hw_models/dram/dram_player.h"

#include <algorithm>
#include <cassert>

#include "sim/ring.h"
#include "sim/unit_report.h"

namespace hw {
namespace {

constexpr std::size_t kAnswers = 64;

/// A channel and all that goes into it. Requests spend a cycle on the wire, so that inside all times are a cycle late.
class Player : DramChannel::Watcher {
 public:
  Player(const DramConfig& config, std::span<const DramRequest> requests, std::uint32_t outstanding)
      : requests_(requests),
        outstanding_(outstanding),
        ranks_(config.organisation.ranks),
        line_(config.line.bytes),
        clock_(config.timing.ck.time),
        in_(outstanding, 1, clock_),
        out_(kAnswers, 1, clock_),
        channel_(config, {{&in_}, {&out_}, this}) {
    in_.wakes(nullptr, &wake_);
    out_.wakes(&wake_, nullptr);
    play_.arrived.resize(requests.size());
    play_.done.resize(requests.size());
  }

  DramPlay run() {
    for (sim::Time now = 0; served_ < requests_.size(); now = next_time(now)) {
      for (; !reads_.empty() && reads_.front() <= now; reads_.pop_front()) waiting_ -= 1;
      for (; may_send() && requests_[next_].earliest <= now; ++next_) send(now);
      while (out_.can_pop(now)) out_.pop(now);
      if (wake_ > now) continue;
      wake_ = sim::kNever;
      wake_ = std::min(wake_, channel_.tick(now));
      take_posted();
    }
    return finish();
  }

 private:
  bool may_send() const { return next_ < requests_.size() && waiting_ < outstanding_; }

  void send(sim::Time now) {
    const DramRequest& r = requests_[next_];
    play_.arrived[next_] = now;
    waiting_ += 1;
    in_.push(now, {r.address / line_ * line_, static_cast<std::uint16_t>(next_ >> 16),
                   static_cast<std::uint16_t>(next_), r.write});
  }

  /// A write is posted: it is over for who sends it when the channel has taken it.
  void take_posted() {
    for (; taken_ + in_.size() < next_; ++taken_) waiting_ -= requests_[taken_].write ? 1 : 0;
  }

  void served(const MemRequest& r, sim::Time end) override {
    const std::size_t i = std::size_t{r.source} << 16 | r.tag;
    play_.done[i] = end - clock_.period();
    play_.end = std::max(play_.end, play_.done[i]);
    if (!r.write) reads_.push_back(end - clock_.period());
    served_ += 1;
  }

  sim::Time next_time(sim::Time now) const {
    sim::Time next = std::min(wake_, out_.pop_at());
    if (may_send()) next = std::min(next, clock_.edge_at_or_after(requests_[next_].earliest));
    if (!may_send() && next_ < requests_.size() && !reads_.empty()) next = std::min(next, reads_.front());
    return std::max(next, now + clock_.period());
  }

  DramPlay finish() {
    channel_.finish(play_.end + clock_.period());
    play_.stats = channel_.stats();
    play_.stats.precharge_standby -= ranks_;
    const sim::UnitReport report = sim::report_of(channel_, "");
    play_.why = report.why;
    play_.why.front().second -= 1;
    return std::move(play_);
  }

  std::span<const DramRequest> requests_;
  const std::uint32_t outstanding_;
  const std::uint32_t ranks_;
  const std::uint64_t line_;
  const sim::Clock clock_;
  sim::Link<MemRequest> in_;
  sim::Link<MemResponse> out_;
  DramChannel channel_;
  sim::Time wake_ = 0;

  std::size_t next_ = 0;
  std::uint32_t waiting_ = 0;   ///< sent and not done
  std::size_t taken_ = 0;       ///< requests that the channel has taken
  std::size_t served_ = 0;      ///< their data are booked
  sim::Ring<sim::Time> reads_;  ///< ends of the reads among them, in the order of commands
  DramPlay play_;
};

}  // namespace

DramPlay play(DramConfig config, std::span<const DramRequest> requests, std::uint32_t outstanding) {
  assert(requests.size() < std::uint64_t{1} << 32 && outstanding > 0);
  config.channels = 1;
  config.fabric = {0};
  if (requests.empty()) return {};
  return Player(config, requests, outstanding).run();
}

}  // namespace hw
