#pragma once
#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "sim/branch_free.h"
#include "sim/time.h"

namespace sim {

/// Handle through which a link lowers a unit's wake-up time, and the minimum of the unit's group in the WakeupTable.
struct WakeupHandle {
  WakeupHandle() = default;
  WakeupHandle(Time* wake) : unit(wake), group(wake) {}  ///< handle of a unit without a group; detached if null
  WakeupHandle(Time* wake, Time* earliest) : unit(wake), group(earliest) {}

  void lower_to(Time time) const {
    *unit = std::min(*unit, time);
    *group = std::min(*group, time);
  }

  Time* unit = nullptr;
  Time* group = nullptr;
};

/// The engine's table of wake-up times: one for each unit, and the minimum of each group of eight consecutive units.
/// The eight times of a group are compared at once (sim/branch_free.h).
class WakeupTable {
 public:
  static constexpr std::size_t kGroup = kMatchWidth;
  /// Rounds a number of units up to whole groups.
  static constexpr std::size_t round_up_to_groups(std::size_t units) { return (units + kGroup - 1) / kGroup * kGroup; }

  WakeupTable() = default;
  /// Creates a wake-up table in which all units wake at time 0.
  explicit WakeupTable(std::size_t units) { reset(units); }
  WakeupTable(const WakeupTable&) = delete;
  WakeupTable& operator=(const WakeupTable&) = delete;

  /// Resizes the wake-up table to `units` units. All of them wake at time `first`.
  void reset(std::size_t units, Time first = 0) {
    groups_.assign(round_up_to_groups(units) / kGroup, Eight{});
    for (Eight& group : groups_) group.fill(kNever);
    group_minima_.assign(round_up_to_groups(groups_.size()), kNever);
    for (std::size_t i = 0; i < units; ++i) lower_to(i, first);
    size_ = units;
  }
  std::size_t size() const { return size_; }

  WakeupHandle handle_of(std::size_t unit) { return {&time_of(unit), &group_minima_[unit / kGroup]}; }
  void lower_to(std::size_t unit, Time time) { handle_of(unit).lower_to(time); }

  /// A range of groups of the wake-up table: groups `first` to `end` - 1.
  struct Groups {
    std::size_t first = 0, end = 0;
  };

  /// Returns the earliest wake-up time of any unit.
  Time earliest_time() const {
    Time first = kNever;
    for (std::size_t i = 0; i < group_minima_.size(); i += kGroup)
      first = std::min(first, min_of_eight(&group_minima_[i]));
    return first;
  }
  /// Returns the earliest wake-up time of any unit in a range of groups.
  Time earliest_time(Groups groups) const {
    return min_of({group_minima_.data() + groups.first, groups.end - groups.first});
  }

  /// Returns the wake-up times of the units in a range of groups; null if the range is empty.
  Time* unit_times(Groups groups) { return groups.first == groups.end ? nullptr : groups_[groups.first].data(); }
  std::span<Time> group_minima(Groups groups) {
    return {group_minima_.data() + groups.first, groups.end - groups.first};
  }

  /// Calls tick(unit) for all units that are due at `now`, the earliest wake-up time of any unit. tick() returns the
  /// unit's next wake-up time. A tick may also lower the wake-up times of other units, to times after `now`.
  template <class Tick>
  void tick_due(Time now, Tick&& tick) {
    tick_due({0, groups_.size()}, now, tick);
  }
  /// Ticks the units in a range of groups that are due at `now`, the earliest wake-up time of the range.
  template <class Tick>
  void tick_due(Groups groups, Time now, Tick&& tick) {
    for (std::size_t g = groups.first; g < groups.end; ++g) {
      if (group_minima_[g] != now) continue;
      Eight& group = groups_[g];
      for (unsigned due = match_mask8(group.data(), now); due != 0; due &= due - 1) {
        const auto i = static_cast<std::size_t>(std::countr_zero(due));
        group[i] = kNever;  // links may lower the unit's time during its tick
        const Time own = tick(g * kGroup + i);
        group[i] = std::min(group[i], own);
      }
      group_minima_[g] = min_of_eight(group.data());
    }
  }

  /// Ticks a unit, even if it is not due.
  template <class Tick>
  void tick_unit(std::size_t unit, Tick&& tick) {
    time_of(unit) = kNever;
    const Time own = tick(unit);
    lower_to(unit, own);
    group_minima_[unit / kGroup] = min_of_eight(groups_[unit / kGroup].data());
  }
  /// Returns the minimum of a few times; kNever for none. A loop of single loads is the fastest for one or two times.
  static Time min_of(std::span<const Time> few_times) {
    Time first = kNever;
    for (const Time& time : few_times) first = std::min(first, load_time(time));
    return first;
  }
  /// Returns the minimum of eight times. The times are loaded one by one, because vector loads of recently written
  /// single times would stall on store forwarding.
  static Time min_of_eight(const Time* eight_times) {
    const Time a = std::min(std::min(load_time(eight_times[0]), load_time(eight_times[1])),
                            std::min(load_time(eight_times[2]), load_time(eight_times[3])));
    const Time b = std::min(std::min(load_time(eight_times[4]), load_time(eight_times[5])),
                            std::min(load_time(eight_times[6]), load_time(eight_times[7])));
    return std::min(a, b);
  }
  /// Returns a mask of the units that wake at `now`. `times`: wake-up times of up to eight groups of units.
  static std::uint64_t due_mask(const Time* times, std::size_t group_count, Time now) {
    std::uint64_t due = match_mask8(times, now);
    for (std::size_t g = 1; g < group_count; ++g)
      due |= std::uint64_t{match_mask8(times + g * kGroup, now)} << g * kGroup;
    return due;
  }
  /// Recomputes the minimum of each group of wake-up times. Returns the minimum of all groups.
  static Time refresh_group_minima(const Time* times, std::span<Time> group_minima) {
    Time first = group_minima.front() = min_of_eight(times);
    for (std::size_t g = 1; g < group_minima.size(); ++g) {
      group_minima[g] = min_of_eight(times + g * kGroup);
      first = std::min(first, group_minima[g]);
    }
    return first;
  }
  Time operator[](std::size_t unit) const { return groups_[unit / kGroup][unit % kGroup]; }

 private:
  using Eight = std::array<Time, kGroup>;

  /// Loads one time with a separate instruction, so that the compiler does not load several at once.
  static Time load_time(const Time& time) { return const_cast<const volatile Time&>(time); }
  Time& time_of(std::size_t unit) { return groups_[unit / kGroup][unit % kGroup]; }

  std::vector<Eight> groups_;
  std::vector<Time> group_minima_;  ///< earliest wake-up time of each group
  std::size_t size_ = 0;
};

}  // namespace sim
