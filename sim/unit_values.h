#pragma once
#include <cstddef>
#include <span>

#include "sim/unit_report.h"

namespace sim {

/// Calls set(value, number, kind) for each value of the units, in the order of write_values(), and updates `elapsed` to
/// the sum of the reasons.
void each_value(std::span<UnitReport> units, auto&& set) {
  std::size_t number = 0;
  for (UnitReport& unit : units) {
    unit.elapsed = 0;
    for (auto& [reason, cycles] : unit.why) {
      set(cycles, number++, CounterKind::kSum);
      unit.elapsed += cycles;
    }
    for (CounterReport& counter : unit.counters) set(counter.value, number++, counter.kind);
  }
}

}  // namespace sim
