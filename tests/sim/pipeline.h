#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "sim/link.h"
#include "sim/machine.h"
#include "sim/unit_report.h"

namespace sim::test {

struct PipelineConfig {
  Clock source{2}, stage{2}, sink{2};
  std::uint64_t items = 50;
  std::size_t capacity = 2;     ///< capacity of each link
  std::uint64_t latency = 1;    ///< latency of each link in cycles
  std::uint64_t depth = 3;      ///< latency of the stage in cycles
  std::size_t in_flight = 2;    ///< maximum number of items inside the stage
  std::uint64_t interval = 1;   ///< minimum cycles between two items that the sink accepts
  std::uint64_t appetite = 50;  ///< number of items after which the sink accepts no more
  bool restless = false;        ///< true: the sink ticks every cycle even when it accepts no more
  Time livelock_timeout = kNever;
};

/// Test unit that sends numbers whenever its link has room.
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
  void finish(Time end) { activity.finish(end); }
  std::string state() const { return std::to_string(out_.size()) + " in its link"; }

  Activity<CycleReason> activity;

 private:
  Clock clock_;
  std::uint64_t left_;
  Link<std::uint64_t>& out_;
};

/// Test unit that forwards each number after a fixed latency.
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
    return std::min(next_transfer_time(now, period, pipe_.pop_at(), out_.push_at()),
                    next_transfer_time(now, period, in_.pop_at(), pipe_.push_at()));
  }
  Clock clock() const { return clock_; }
  void finish(Time end) { activity.finish(end); }
  std::string state() const { return std::to_string(out_.size()) + " in its link"; }

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

/// Test unit that receives a number, then waits for an interval.
class Sink {
 public:
  enum class CycleReason : std::uint8_t { kStarved, kTaking, kResting, kCount };
  Sink(const PipelineConfig& c, Link<std::uint64_t>& in)
      : clock_(c.sink), rest_(c.interval * c.sink.period()), appetite_(c.appetite), restless_(c.restless), in_(in) {}

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
    if (restless_ && taken.size() == appetite_) return next;
    return taken.size() < appetite_ ? in_.pop_at() : kNever;
  }
  Clock clock() const { return clock_; }
  std::uint64_t retired_items() const { return taken.size(); }
  void finish(Time end) { activity.finish(end); }

  Activity<CycleReason> activity;
  std::vector<std::uint64_t> taken;
  std::vector<Time> times;

 private:
  CycleReason waiting(Time at) const { return at < free_ ? CycleReason::kResting : CycleReason::kStarved; }

  Clock clock_;
  Time rest_;
  Time free_ = 0;
  std::uint64_t appetite_;
  bool restless_;
  Link<std::uint64_t>& in_;
};

///   Test machine of three units, each in its own partition: source --> stage --> sink.
class Pipeline {
 public:
  explicit Pipeline(const PipelineConfig& c)
      : config_(c),
        source_id_(machine_.unit({.name = "source", .clock = c.source, .partition = 1})),
        stage_id_(machine_.unit({.name = "stage", .clock = c.stage})),
        sink_id_(machine_.unit({.name = "sink", .clock = c.sink, .partition = 2})),
        first_(machine_.link<std::uint64_t>(c.capacity, c.latency, source_id_, stage_id_)),
        second_(machine_.link<std::uint64_t>(c.capacity, c.latency, stage_id_, sink_id_)),
        source(machine_.build<Source>(source_id_, c, first_)),
        stage(machine_.build<Stage>(stage_id_, c, first_, second_)),
        sink(machine_.build<Sink>(sink_id_, c, second_)) {}

  Machine& machine() { return machine_; }
  bool done() const { return sink.taken.size() == config_.items; }
  Time livelock_timeout() const { return config_.livelock_timeout; }
  /// Ends the run and returns the time spent for each cycle reason: of the source, the stage, then the sink.
  std::vector<Time> spent(Time end) {
    machine_.finish(end + 1);
    std::vector<Time> all;
    const auto add = [&]<class CycleReason>(const Activity<CycleReason>& activity) {
      for (std::size_t i = 0; i < activity.kReasons; ++i) all.push_back(activity.spent(static_cast<CycleReason>(i)));
    };
    add(source.activity);
    add(stage.activity);
    add(sink.activity);
    return all;
  }

 protected:
  const PipelineConfig config_;
  Machine machine_{1};

 private:
  UnitId source_id_, stage_id_, sink_id_;
  Link<std::uint64_t>&first_, &second_;

 public:
  Source& source;
  Stage& stage;
  Sink& sink;
};

/// A Pipeline whose partitions may run ahead of each other.
class ApartPipeline : public Pipeline {
 public:
  using Pipeline::Pipeline;
  /// Forbids partitions to run ahead near the end, where the run could finish.
  RunLimits run_limits(Time now) const {
    const bool ends_soon = config_.items - sink.taken.size() <= config_.capacity;
    const Time end = ends_soon ? now : now + machine_.min_lookahead();
    return {end, end};
  }
};

}  // namespace sim::test
