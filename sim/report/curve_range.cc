#include "sim/report/curve_range.h"

#include <set>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "sim/config/quantity.h"
#include "sim/report/energy_table.h"
#include "sim/report/unit_entry.h"

namespace sim {
namespace {

/// The array of a kind of unit, and the range of sizes of its curve.
struct Array {
  std::string kind;
  std::uint64_t bytes, least, most;
  auto operator<=>(const Array&) const = default;
};
/// Table entries by array, for arrays outside their curves.
using Outside = std::map<Array, std::set<std::string>>;

void add(const EnergyTable& table, const std::string& entry, const UnitReport& unit, Outside& outside) {
  if (!table.contains(entry) || !table.curve(entry).depends_on_size()) return;
  const EnergyCurve& curve = table.curve(entry);
  if (unit.cache_bytes >= curve.least_bytes() && unit.cache_bytes <= curve.most_bytes()) return;
  outside[{entry_name(unit), unit.cache_bytes, curve.least_bytes(), curve.most_bytes()}].insert(entry);
}

std::string size_text(std::uint64_t bytes) { return quantity_text(bytes, byte_units()); }

void tell(const char* table, const Outside& outside, std::vector<std::string>& lines) {
  for (const auto& [array, entries] : outside) {
    lines.push_back(fmt::format("{}: the array of {} has {}, outside {} to {} of {}, and is extrapolated", table,
                                array.kind, size_text(array.bytes), size_text(array.least), size_text(array.most),
                                fmt::join(entries, ", ")));
  }
}

}  // namespace

std::vector<std::string> sizes_outside_curves(std::span<const UnitReport> units,
                                              const std::map<std::string, Spread>& events,
                                              const std::map<std::string, Spread>& arrays) {
  const EnergyTable energy(events), area(arrays, "area.arrays");
  Outside of_energy, of_area;
  for (const UnitReport& unit : units) {
    if (unit.cache_bytes == 0) continue;
    for (const CounterReport& counter : unit.counters) add(energy, counter.event, unit, of_energy);
    const std::string name = entry_name(unit);
    add(area, area.contains(name) ? name : unit.block, unit, of_area);
  }
  std::vector<std::string> lines;
  tell("energy.events", of_energy, lines);
  tell("area.arrays", of_area, lines);
  return lines;
}

}  // namespace sim
