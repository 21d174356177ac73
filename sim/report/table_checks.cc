#include "sim/report/table_checks.h"

#include <algorithm>
#include <map>
#include <set>
#include <string_view>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "sim/config/quantity.h"
#include "sim/edit_distance.h"
#include "sim/error.h"
#include "sim/report/energy.h"

namespace sim {
namespace {

using Names = std::set<std::string>;

/// Throws InputError for a table entry with an unknown name. `fault`: the problem, such as "no counter names this
/// event".
[[noreturn]] void throw_unknown_entry(std::string_view table, const std::string& name, std::string_view fault,
                                      const Names& known) {
  const std::string_view start = comparison_prefix(name);
  const auto found = find_nearest(start, known, std::max<std::size_t>(1, start.size() / 3));
  throw InputError(fmt::format("{}.{}: {}{}; allowed: {}", table, name, fault,
                               found == known.end() ? "" : fmt::format(", did you mean '{}'?", *found),
                               fmt::join(known, ", ")));
}

std::string whole_entry(std::string_view entry) { return std::string(entry); }

/// Throws InputError unless the names of all entries of an energy or area table are known. `name_of`: returns the name
/// of an entry, without a size at the end if the table has sizes.
void check_entries(std::string_view table, const std::map<std::string, Band>& entries, std::string_view fault,
                   const Names& known, std::string (*name_of)(std::string_view) = whole_entry) {
  for (const auto& [entry, value] : entries) {
    if (const std::string name = name_of(entry); !known.contains(name)) throw_unknown_entry(table, name, fault, known);
  }
}

constexpr std::string_view kNoUnit = "no unit goes by this name";

Names names_of(std::span<const UnitReport> units) {
  Names names;
  for (const UnitReport& unit : units) names.insert({entry_name(unit), unit.block});
  return names;
}

Names parts_of(std::span<const UnitReport> units) {
  Names names;
  for (const UnitReport& unit : units) {
    for (const UnitPart& part : unit.parts) {
      for (const std::string& name : {entry_name(unit), unit.block}) names.insert(name + "." + part.name);
    }
  }
  return names;
}

}  // namespace

void check_energy_events(const EnergyConfig& config, std::span<const std::string> declared) {
  const Names known(declared.begin(), declared.end());
  check_entries("energy.events", config.events, "no counter names this event", known, event_name_of);
  const EnergyTable table(config.events);
  for (const std::string& name : known) {
    if (!table.contains(name)) throw InputError(fmt::format("energy.events: no figure for '{}'", name));
  }
}

void check_unit_names(const EnergyConfig& config, std::span<const UnitReport> units) {
  const Names known = names_of(units), parts = parts_of(units);
  check_entries("energy.logic", config.logic, kNoUnit, known);
  check_entries("energy.flops", config.flops, kNoUnit, known);
  check_entries("energy.parts", config.parts, "no unit has a part of this name", parts);
  check_entries("energy.parts_in_logic", config.parts_in_logic, "no unit has a part of this name", parts);
}

void check_unit_names(const AreaConfig& config, std::span<const UnitReport> units) {
  const Names known = names_of(units);
  check_entries("area.arrays", config.arrays, kNoUnit, known, event_name_of);
  check_entries("area.buffers", config.buffers, kNoUnit, known);
  check_entries("area.pads", config.pads, kNoUnit, known);
}

namespace {

/// The memory array of one kind of unit, and the range of sizes of its energy or area curve.
struct Array {
  std::string kind;
  std::uint64_t bytes, least, most;
  auto operator<=>(const Array&) const = default;
};
/// Memory arrays whose size is outside their energy or area curve, each with the names of its table entries.
using ArraysOutsideCurve = std::map<Array, std::set<std::string>>;

void add_if_outside(const EnergyTable& table, const std::string& entry, const UnitReport& unit,
                    ArraysOutsideCurve& outside) {
  if (!table.contains(entry) || !table.curve_of(entry).depends_on_size()) return;
  const EnergyCurve& curve = table.curve_of(entry);
  if (unit.cache_bytes >= curve.smallest_array_bytes() && unit.cache_bytes <= curve.largest_array_bytes()) return;
  outside[{entry_name(unit), unit.cache_bytes, curve.smallest_array_bytes(), curve.largest_array_bytes()}].insert(
      entry);
}

std::string size_text(std::uint64_t bytes) { return quantity_text(bytes, byte_units()); }

void append_warnings(const char* table, const ArraysOutsideCurve& outside, std::vector<std::string>& lines) {
  for (const auto& [array, entries] : outside) {
    lines.push_back(fmt::format("{}: the array of {} has {}, outside {} to {} of {}, and is extrapolated", table,
                                array.kind, size_text(array.bytes), size_text(array.least), size_text(array.most),
                                fmt::join(entries, ", ")));
  }
}

}  // namespace

std::vector<std::string> curve_range_warnings(std::span<const UnitReport> units,
                                              const std::map<std::string, Band>& events,
                                              const std::map<std::string, Band>& arrays) {
  const EnergyTable energy(events), area(arrays, "area.arrays");
  ArraysOutsideCurve of_energy, of_area;
  for (const UnitReport& unit : units) {
    if (unit.cache_bytes == 0) continue;
    for (const CounterReport& counter : unit.counters) add_if_outside(energy, counter.event, unit, of_energy);
    const std::string name = entry_name(unit);
    add_if_outside(area, area.contains(name) ? name : unit.block, unit, of_area);
  }
  std::vector<std::string> lines;
  append_warnings("energy.events", of_energy, lines);
  append_warnings("area.arrays", of_area, lines);
  return lines;
}

}  // namespace sim
