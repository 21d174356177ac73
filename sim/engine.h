#pragma once
#include <algorithm>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "sim/error.h"
#include "sim/hash.h"
#include "sim/machine.h"
#include "sim/time.h"

namespace sim {

enum class Skip : std::uint8_t {
  kOn,   ///< the engine jumps to the next wake-up time of any unit
  kOff,  ///< the engine visits every clock edge of every unit; slow, for checks of kOn
};

/// Members that the engine requires of the class (Owner) that owns a simulated machine:
///   machine()      its units and links
///   done()         true once all work has left the machine
/// Optional, to run the machine's partitions one after the other:
///   run_limits(t)  limits of the partitions once all have reached time t; not after a time at which done() may
///                  become true
/// Optional, to detect livelock:
///   livelock_timeout()     longest time that may pass without a retired item
template <class Owner>
concept HasPartitions = requires(Owner& owner, Time now) {
  owner.run_limits(now);
};

template <class Owner>
concept HasLivelockTimeout = requires(const Owner& owner) {
  owner.livelock_timeout();
};

/// Does periodic checks during a run of a simulated machine. It samples all counters at interval boundaries, and
/// detects livelock: units are active but retire nothing.
template <class Owner>
class Watchdog {
 public:
  explicit Watchdog(Owner& owner) : owner_(owner) {
    if constexpr (HasLivelockTimeout<Owner>) progress_due_at_ = livelock_timeout_ = owner.livelock_timeout();
    next_check_at_ = std::min(progress_due_at_, owner_.machine().next_interval_boundary());
  }
  /// Performs the checks that are due by `now`, the next wake-up time of any unit. All units must have finished the
  /// work before `now`. Throws Deadlock if no item has been retired for livelock_timeout().
  void run_due_checks(Time now) {
    if (now >= next_check_at_ && now != kNever) run_checks(now);
  }
  /// Returns the next interval boundary, at which all counters are sampled. No partition may run beyond the boundary
  /// before all have reached it.
  Time next_interval_boundary() const { return owner_.machine().next_interval_boundary(); }

 private:
  void run_checks(Time now) {
    Machine& machine = owner_.machine();
    if (now >= machine.next_interval_boundary()) machine.sample_intervals_until(now);
    if (now >= progress_due_at_) check_progress(now);
    next_check_at_ = std::min(progress_due_at_, machine.next_interval_boundary());
  }
  void check_progress(Time now) {
    Machine& machine = owner_.machine();
    const std::uint64_t retired = machine.retired_items();
    if (retired == retired_) {
      throw Deadlock("the machine is in a livelock: its units go on, and none has retired anything for " +
                         std::to_string(livelock_timeout_ / kFemtosecondsPerNanosecond) +
                         " ns, the time that its watchdog gives it",
                     machine.state());
    }
    retired_ = retired;
    progress_due_at_ = now + std::min(livelock_timeout_, kNever - now);
  }

  Owner& owner_;
  Time livelock_timeout_ = kNever, progress_due_at_ = kNever;
  Time next_check_at_ = kNever;  ///< time at which the next periodic check is due
  std::uint64_t retired_ = 0;
};

/// Runs the inner partition of a machine, without the other partitions, up to its limit. Returns its next wake-up time.
/// `others_reached`: time that the other partitions have reached. `end`: limit of the run.
template <class TickAt>
Time run_inner_partition(WakeupTable& wakeups, const Partition& inner, Time others_reached, Time end,
                         TickAt&& tick_at) {
  Time at = wakeups.earliest_time(inner.units);
  for (; at < run_limit(inner, others_reached, end); at = wakeups.earliest_time(inner.units)) {
    wakeups.tick_due(inner.units, at, tick_at(at));
  }
  return at;
}

/// Runs an outer partition of a machine, without the other partitions, up to its limit. Returns its next wake-up time.
/// The partition's cluster runs by itself while no other unit is due. `inner_reached`: time that the inner partition
/// has reached.
template <class TickAt>
Time run_outer_partition(WakeupTable& wakeups, const Partition& partition, Time inner_reached, Time end,
                         TickAt&& tick_at) {
  const Cluster& cluster = partition.cluster;
  const auto clustered_units = wakeups.group_minima(cluster.units), other_units = wakeups.group_minima(partition.units);
  const ClusterTurn turn{
      wakeups.unit_times(cluster.units), clustered_units, partition, inner_reached, end, other_units};
  for (;;) {
    const Time others = WakeupTable::min_of(other_units), clustered = WakeupTable::min_of(clustered_units);
    const Time at = std::min(others, clustered);
    if (at >= run_limit(partition, inner_reached, end)) return at;
    if (clustered == at) cluster.run(cluster.owner, turn, at);
    if (others == at) wakeups.tick_due(partition.units, at, tick_at(at));
  }
}

/// Runs the partitions of a machine one after the other, each up to its limit, as long as limits allow. Returns the
/// time from which the engine must run all units together, or kNever if no unit wakes. No partition runs beyond an
/// interval boundary before all have reached it.
template <class Owner, class TickAt>
Time run_partitions(Owner& owner, Time now, Watchdog<Owner>& watchdog, TickAt&& tick_at) {
  WakeupTable& wakeups = owner.machine().wakeup_table();
  Partitions& partitions = owner.machine().partitions();
  const std::size_t count = partitions.outer.size();
  // The order of the partitions alternates, because the partition that ran last is still in the host's caches.
  for (bool back = false;; back = !back, now = wakeups.earliest_time()) {
    if (now == kNever) return now;
    RunLimits reach = owner.run_limits(now);
    if (reach.end <= now) return now;
    watchdog.run_due_checks(now);
    reach.end = std::min(reach.end, watchdog.next_interval_boundary());
    const Time next = run_inner_partition(wakeups, partitions.inner, now, std::min(reach.lead, reach.end), tick_at);
    // Time that the inner partition has reached. While one of its links is nearly full, a pop could wake the partition
    // at once, so it counts as being at `now`.
    const Time led = partitions.inner.nearly_full == 0 ? std::min(next, reach.end) : now;
    Time reached = reach.end;  // time reached by all outer partitions
    for (std::size_t i = 0; i < count; ++i) {
      const Partition& partition = partitions.outer[back ? count - 1 - i : i];
      reached = std::min(reached, run_outer_partition(wakeups, partition, led, reach.end, tick_at));
    }
    run_inner_partition(wakeups, partitions.inner, reached, reached, tick_at);
  }
}

/// The units of one clock, as indices into the engine's wake-up table.
struct UnitsOfClock {
  Clock clock;
  std::vector<std::size_t> units;
};

/// Groups the units of a machine by clock.
inline std::vector<UnitsOfClock> group_units_by_clock(const Machine& machine) {
  std::vector<UnitsOfClock> groups;
  machine.for_each_clock([&](std::size_t unit, Clock clock) {
    auto group = std::ranges::find(groups, clock, &UnitsOfClock::clock);
    if (group == groups.end()) group = groups.insert(group, UnitsOfClock{clock, {}});
    group->units.push_back(unit);
  });
  return groups;
}

/// Runs a simulated machine until its owner's done() is true. Returns the time of the last clock edge visited. Throws
/// Deadlock if the machine is stuck.
template <Skip kSkip = Skip::kOn, class Owner>
Time run(Owner& owner) {
  Machine& machine = owner.machine();
  machine.start();
  WakeupTable& wakeups = machine.wakeup_table();
  const auto tick_at = [units = machine.tick_functions().data()](Time now) {
    return [units, now](std::size_t i) { return units[i](now); };
  };
  Watchdog<Owner> watchdog(owner);
  std::vector<UnitsOfClock> groups;
  if constexpr (kSkip == Skip::kOff) groups = group_units_by_clock(machine);
  Time now = 0;
  if constexpr (kSkip == Skip::kOn && HasPartitions<Owner>) now = wakeups.earliest_time();
  for (;;) {
    if constexpr (kSkip == Skip::kOn && HasPartitions<Owner>) now = run_partitions(owner, now, watchdog, tick_at);
    watchdog.run_due_checks(now);
    if constexpr (kSkip == Skip::kOff) {
      for (const UnitsOfClock& group : groups) {
        if (!group.clock.is_edge(now)) continue;
        for (const std::size_t i : group.units) wakeups.tick_unit(i, tick_at(now));
      }
    } else {
      if (now != kNever) wakeups.tick_due(now, tick_at(now));
    }
    if (owner.done()) return now;
    const Time next = wakeups.earliest_time();
    if (next == kNever) throw Deadlock("the machine is stuck", machine.state());
    if constexpr (kSkip == Skip::kOff) {
      Time edge = kNever;
      for (const UnitsOfClock& group : groups) edge = std::min(edge, group.clock.edge_at_or_after(now + 1));
      now = edge;
    } else {
      now = next;
    }
  }
}

/// Runs a simulated machine like run(), but ticks the units that are due at the same time in a pseudo-random order
/// given by `seed`. For tests that results do not depend on the order.
template <class Owner>
Time run_shuffled(Owner& owner, std::uint64_t seed) {
  Machine& machine = owner.machine();
  machine.start();
  WakeupTable& wakeups = machine.wakeup_table();
  std::vector<std::pair<std::uint64_t, std::size_t>> order;  // hash and index of each due unit
  Watchdog<Owner> watchdog(owner);
  for (Time now = 0;;) {
    watchdog.run_due_checks(now);
    order.clear();
    for (std::size_t i = 0; i < wakeups.size(); ++i) {
      if (wakeups[i] == now) order.emplace_back(hash(seed, now, i), i);
    }
    std::ranges::sort(order);
    for (const auto& [drawn, i] : order)
      wakeups.tick_unit(i, [&](std::size_t unit) { return machine.tick_functions()[unit](now); });
    if (owner.done()) return now;
    now = wakeups.earliest_time();
    if (now == kNever) throw Deadlock("the machine is stuck", machine.state());
  }
}

}  // namespace sim
