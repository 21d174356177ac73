#pragma once
#include <cstdint>
#include <string>
#include <type_traits>
#include <vector>

#include "sim/activity.h"
#include "sim/link.h"
#include "sim/partitions.h"

namespace sim::test {

struct PipelineConfig {
  Clock source{2}, stage{2}, sink{2};
  std::uint64_t items = 50;
  std::size_t capacity = 2;     ///< of each link
  std::uint64_t latency = 1;    ///< of each link
  std::uint64_t depth = 3;      ///< of the stage's pipe
  std::size_t in_flight = 2;    ///< inside the stage's pipe
  std::uint64_t interval = 1;   ///< cycles the sink rests after each item
  std::uint64_t appetite = 50;  ///< items the sink takes at all
};

/// Sends numbers as fast as there is room.
class Source {
 public:
  enum class CycleReason : std::uint8_t { kDone, kSending, kFull, kCount };
  Source(const PipelineConfig& c, Link<std::uint64_t>& out) : clock_(c.source), left_(c.items), out_(out) {}

  Time tick(Time now) {
    const bool worked = left_ > 0 && out_.can_push(now);
    if (worked) out_.push(now, left_--);
    const CycleReason then = left_ > 0 ? CycleReason::kFull : CycleReason::kDone;
    activity.spend(now, clock_.period(), worked ? CycleReason::kSending : then, then);
    return left_ > 0 ? std::max(now + clock_.period(), out_.push_at()) : kNever;
  }
  Clock clock() const { return clock_; }

  Activity<CycleReason> activity;

 private:
  Clock clock_;
  std::uint64_t left_;
  Link<std::uint64_t>& out_;
};

/// Holds each number for the length of its pipe.
class Stage {
 public:
  enum class CycleReason : std::uint8_t { kStarved, kWorking, kInside, kFull, kCount };
  Stage(const PipelineConfig& c, Link<std::uint64_t>& in, Link<std::uint64_t>& out)
      : clock_(c.stage), pipe_(c.in_flight, c.depth, c.stage), in_(in), out_(out) {}

  Time tick(Time now) {
    bool worked = false;
    if (pipe_.can_pop(now) && out_.can_push(now)) {
      out_.push(now, pipe_.pop(now));
      worked = true;
    }
    if (in_.can_pop(now) && pipe_.can_push(now)) {
      pipe_.push(now, in_.pop(now));
      worked = true;
    }
    const Time period = clock_.period();
    activity.spend(now, period, worked ? CycleReason::kWorking : waiting(now), waiting(now + period));
    return std::min(opens(now, period, pipe_.pop_at(), out_.push_at()),
                    opens(now, period, in_.pop_at(), pipe_.push_at()));
  }
  Clock clock() const { return clock_; }

  Activity<CycleReason> activity;

 private:
  CycleReason waiting(Time at) const {
    if (pipe_.pop_at() == kNever) return CycleReason::kStarved;
    return pipe_.pop_at() <= at ? CycleReason::kFull : CycleReason::kInside;
  }

  Clock clock_;
  Link<std::uint64_t> pipe_;
  Link<std::uint64_t>& in_;
  Link<std::uint64_t>& out_;
};

/// Takes a number, then rests.
class Sink {
 public:
  enum class CycleReason : std::uint8_t { kStarved, kTaking, kResting, kCount };
  Sink(const PipelineConfig& c, Link<std::uint64_t>& in)
      : clock_(c.sink), rest_(c.interval * c.sink.period()), appetite_(c.appetite), in_(in) {}

  Time tick(Time now) {
    const bool worked = now >= free_ && in_.can_pop(now) && taken.size() < appetite_;
    if (worked) {
      taken.push_back(in_.pop(now));
      times.push_back(now);
      free_ = now + rest_;
    }
    const Time next = now + clock_.period();
    activity.spend(now, clock_.period(), worked ? CycleReason::kTaking : waiting(now), waiting(next));
    if (free_ > now) return free_;
    return taken.size() < appetite_ ? in_.pop_at() : kNever;
  }
  Clock clock() const { return clock_; }

  Activity<CycleReason> activity;
  std::vector<std::uint64_t> taken;
  std::vector<Time> times;

 private:
  CycleReason waiting(Time at) const { return at < free_ ? CycleReason::kResting : CycleReason::kStarved; }

  Clock clock_;
  Time rest_;
  Time free_ = 0;
  std::uint64_t appetite_;
  Link<std::uint64_t>& in_;
};

///   source --> stage --> sink, each with a group of wake-up times to itself
class Pipeline {
 public:
  explicit Pipeline(const PipelineConfig& c)
      : config_(c),
        first_(c.capacity, c.latency, c.source, c.stage, 1),
        second_(c.capacity, c.latency, c.stage, c.sink, 1),
        source(c, first_),
        stage(c, first_, second_),
        sink(c, second_) {
    wakes_.reset(place(3), kNever);
    each_unit([&](auto&, std::size_t unit) { wakes_.lower(unit, 0); });
    first_.wakes(wakes_.of(place(0)), wakes_.of(place(1)));
    second_.wakes(wakes_.of(place(1)), wakes_.of(place(2)));
  }

  void each_unit(auto&& f) {
    f(source, place(0));
    f(stage, place(1));
    f(sink, place(2));
  }
  Wakes& wakes() { return wakes_; }
  bool done() const { return sink.taken.size() == config_.items; }
  std::string state() const {
    return "first link: " + std::to_string(first_.size()) + "\nsecond link: " + std::to_string(second_.size());
  }
  /// Where each unit's time went, in the order of units and reasons.
  std::vector<Time> spent(Time end) {
    std::vector<Time> all;
    each_unit([&](auto& unit, std::size_t) {
      using CycleReason = typename std::remove_reference_t<decltype(unit)>::CycleReason;
      unit.activity.finish(unit.clock().edge_at_or_after(end + 1));
      for (std::size_t i = 0; i < unit.activity.kReasons; ++i)
        all.push_back(unit.activity.spent(static_cast<CycleReason>(i)));
    });
    return all;
  }

 private:
  static std::size_t place(std::size_t unit) { return unit * Wakes::kGroup; }

 protected:
  const PipelineConfig config_;

 private:
  Wakes wakes_;

 protected:
  Link<std::uint64_t> first_, second_;

 public:
  Source source;
  Stage stage;
  Sink sink;
};

/// The same as three partitions.
class ApartPipeline : public Pipeline {
 public:
  explicit ApartPipeline(const PipelineConfig& c) : Pipeline(c) {
    partitions_.outer = {{{0, 1}}, {{2, 3}}};
    partitions_.inner = {{1, 2}};
    first_.count_if_nearly_full(&partitions_.outer[0].nearly_full);
  }
  Partitions& partitions() { return partitions_; }
  /// The last items are taken with all partitions at the same time.
  Time lookahead_end(Time now) const {
    const bool ends_soon = config_.items - sink.taken.size() <= second_.capacity();
    return ends_soon ? now : now + std::min(first_.latency(), second_.latency());
  }

 private:
  Partitions partitions_;
};

}  // namespace sim::test
