#pragma once
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <typeindex>
#include <vector>

#include <fmt/format.h>

#include "sim/unit_report.h"

namespace tools {

/// Returns a counter's name in reports. `counter`: pointer to a member of `Stats`, or a function from Stats to a
/// member.
template <class Stats>
std::string_view counter_name(auto&& counter) {
  const Stats stats{};
  std::string_view found;
  Stats::describe(stats, [&](const std::uint64_t& value, const char* name, auto&&...) {
    if (&value == &std::invoke(counter, stats)) found = name;
  });
  if (found.empty()) throw std::logic_error("a counter that its unit does not declare");
  return found;
}

/// Returns the report path of a counter's sum over all units of a kind.
template <class Unit>
std::string counter_path(std::uint64_t Unit::Stats::*counter, std::string_view kind = Unit::kName) {
  return fmt::format("units.{}.counters.{}", kind, counter_name<typename Unit::Stats>(counter));
}

/// The units of one type in a report, and sums of their counters; sums are 0 if there are no units.
template <class Unit>
class Units {
 public:
  using Stats = typename Unit::Stats;
  using CycleReason = typename Unit::CycleReason;

  /// Selects the units of this type whose path starts with `prefix`.
  explicit Units(std::span<const sim::UnitReport> units, std::string_view prefix = {}) {
    for (const sim::UnitReport& unit : units) {
      if (unit.type == typeid(Unit) && unit.path.starts_with(prefix)) units_.push_back(&unit);
    }
  }

  bool empty() const { return units_.empty(); }
  std::uint64_t elapsed() const {
    return sum([](const sim::UnitReport& unit) { return unit.elapsed; });
  }
  /// Returns the cycles that all units together spent for one cycle reason, e.g. waiting for a miss.
  std::uint64_t spent(CycleReason reason) const {
    return sum(
        [&](const sim::UnitReport& unit) { return unit.cycles_by_reason.at(static_cast<std::size_t>(reason)).second; });
  }
  /// Returns the sum of a counter over the units; `counter` as for counter_name().
  std::uint64_t sum_of(auto&& counter) const {
    const std::string_view name = counter_name<Stats>(counter);
    return sum([&](const sim::UnitReport& unit) {
      const auto found = std::ranges::find(unit.counters, name, &sim::CounterReport::name);
      if (found == unit.counters.end()) throw std::logic_error(unit.path + " reports no " + std::string(name));
      return found->value;
    });
  }
  /// Returns the share of the units' total time that was spent for one cycle reason, 0 to 1.
  double share(CycleReason reason) const {
    return elapsed() == 0 ? 0 : static_cast<double>(spent(reason)) / static_cast<double>(elapsed());
  }
  double clock_mhz() const { return units_.empty() ? 1 : units_.front()->clock_mhz; }

 private:
  std::uint64_t sum(auto&& of) const {
    std::uint64_t total = 0;
    for (const sim::UnitReport* unit : units_) total += of(*unit);
    return total;
  }

  std::vector<const sim::UnitReport*> units_;
};

}  // namespace tools
