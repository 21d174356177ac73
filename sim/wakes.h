#pragma once
#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "sim/eight.h"
#include "sim/time.h"

namespace sim {

/// Handle through which a link lowers a unit's wake-up time and the minimum of its group.
struct Waker {
  Waker() = default;
  Waker(Time* wake) : unit(wake), group(wake) {}  ///< without a group; detached if nullptr
  Waker(Time* wake, Time* earliest) : unit(wake), group(earliest) {}

  void lower(Time at) const {
    *unit = std::min(*unit, at);
    *group = std::min(*group, at);
  }

  Time* unit = nullptr;
  Time* group = nullptr;
};

/// The engine's wake-up times: one for each unit, and the minimum of each group of eight neighbours. A group is
/// compared at once (sim/eight.h).
class Wakes {
 public:
  static constexpr std::size_t kGroup = kEight;
  /// `units` rounded up to whole groups.
  static constexpr std::size_t whole_groups(std::size_t units) { return (units + kGroup - 1) / kGroup * kGroup; }

  Wakes() = default;
  /// All units wake at time 0.
  explicit Wakes(std::size_t units) { reset(units); }
  Wakes(const Wakes&) = delete;
  Wakes& operator=(const Wakes&) = delete;

  /// All units wake at `first`.
  void reset(std::size_t units, Time first = 0) {
    groups_.assign(whole_groups(units) / kGroup, Eight{});
    for (Eight& group : groups_) group.fill(kNever);
    earliest_.assign(whole_groups(groups_.size()), kNever);
    for (std::size_t i = 0; i < units; ++i) lower(i, first);
    size_ = units;
  }
  std::size_t size() const { return size_; }

  Waker of(std::size_t unit) { return {&at(unit), &earliest_[unit / kGroup]}; }
  void lower(std::size_t unit, Time time) { of(unit).lower(time); }

  /// A range of groups.
  struct Groups {
    std::size_t first = 0, end = 0;
  };

  /// The earliest time of all units.
  Time earliest() const {
    Time first = kNever;
    for (std::size_t i = 0; i < earliest_.size(); i += kGroup) first = std::min(first, least(&earliest_[i]));
    return first;
  }
  /// The earliest time of a range.
  Time earliest(Groups of) const {
    Time first = kNever;
    for (std::size_t g = of.first; g < of.end; ++g) first = std::min(first, one(earliest_[g]));
    return first;
  }

  /// The times of a range's units, and the minima of its groups.
  Time* times(Groups of) { return of.first == of.end ? nullptr : groups_[of.first].data(); }
  std::span<Time> earliest_of_each(Groups of) { return {earliest_.data() + of.first, of.end - of.first}; }

  /// Calls tick(unit) for all units that are due at `now`, the earliest time of all. tick() returns the unit's next
  /// wake-up time. Ticks may lower any unit's time to one after `now`.
  template <class Tick>
  void tick_due(Time now, Tick&& tick) {
    tick_due({0, groups_.size()}, now, tick);
  }
  /// Ticks the due units of a range; `now` is its earliest time. Returns its next earliest time.
  template <class Tick>
  Time tick_due(Groups of, Time now, Tick&& tick) {
    for (std::size_t g = of.first; g < of.end; ++g) {
      if (earliest_[g] != now) continue;
      Eight& group = groups_[g];
      for (unsigned due = equal_of_eight(group.data(), now); due != 0; due &= due - 1) {
        const auto i = static_cast<std::size_t>(std::countr_zero(due));
        group[i] = kNever;  // links may lower it during the tick
        const Time own = tick(g * kGroup + i);
        group[i] = std::min(group[i], own);
      }
      earliest_[g] = least(group.data());
    }
    return earliest(of);
  }

  /// Ticks one unit whether or not it is due.
  template <class Tick>
  void tick_one(std::size_t unit, Tick&& tick) {
    at(unit) = kNever;
    const Time own = tick(unit);
    lower(unit, own);
    earliest_[unit / kGroup] = least(groups_[unit / kGroup].data());
  }
  /// The minimum of eight times that were just written one by one. Reading them in pairs, as a compiler would, stalls
  /// on store forwarding.
  static Time least(const Time* eight) {
    const Time a = std::min(std::min(one(eight[0]), one(eight[1])), std::min(one(eight[2]), one(eight[3])));
    const Time b = std::min(std::min(one(eight[4]), one(eight[5])), std::min(one(eight[6]), one(eight[7])));
    return std::min(a, b);
  }
  /// Mask of the units, in up to eight groups, that wake at `now`.
  static std::uint64_t due(const Time* times, std::size_t groups, Time now) {
    std::uint64_t due = equal_of_eight(times, now);
    for (std::size_t g = 1; g < groups; ++g)
      due |= std::uint64_t{equal_of_eight(times + g * kGroup, now)} << g * kGroup;
    return due;
  }
  /// Updates the minimum of each group and returns the minimum of all.
  static Time look_again(const Time* times, std::span<Time> earliest_of_each) {
    Time first = earliest_of_each.front() = least(times);
    for (std::size_t g = 1; g < earliest_of_each.size(); ++g) {
      earliest_of_each[g] = least(times + g * kGroup);
      first = std::min(first, earliest_of_each[g]);
    }
    return first;
  }
  Time operator[](std::size_t unit) const { return groups_[unit / kGroup][unit % kGroup]; }

 private:
  using Eight = std::array<Time, kGroup>;

  /// Reads one time with a load of its own.
  static Time one(const Time& time) { return const_cast<const volatile Time&>(time); }
  Time& at(std::size_t unit) { return groups_[unit / kGroup][unit % kGroup]; }

  std::vector<Eight> groups_;
  std::vector<Time> earliest_;  ///< minimum of each group
  std::size_t size_ = 0;
};

}  // namespace sim
