#include "sim/report/table_names.h"

#include <algorithm>
#include <map>
#include <set>
#include <string_view>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "sim/edit_distance.h"
#include "sim/error.h"
#include "sim/report/energy_table.h"
#include "sim/report/unit_entry.h"

namespace sim {
namespace {

using Names = std::set<std::string>;

/// `unknown`: what is wrong with an entry, such as "no counter names this event".
[[noreturn]] void refuse(std::string_view table, const std::string& name, std::string_view unknown,
                         const Names& known) {
  const std::string_view start = start_of(name);
  const auto found = nearest_of(start, known, std::max<std::size_t>(1, start.size() / 3));
  throw InputError(fmt::format("{}.{}: {}{}; allowed: {}", table, name, unknown,
                               found == known.end() ? "" : fmt::format(", did you mean '{}'?", *found),
                               fmt::join(known, ", ")));
}

std::string whole(std::string_view entry) { return std::string(entry); }

/// `name_of` extracts the name of an entry: all of it, or event_of() where a size may follow.
void check(std::string_view table, const std::map<std::string, Spread>& entries, std::string_view unknown,
           const Names& known, std::string (*name_of)(std::string_view) = whole) {
  for (const auto& [entry, figure] : entries) {
    if (const std::string name = name_of(entry); !known.contains(name)) refuse(table, name, unknown, known);
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
  check("energy.events", config.events, "no counter names this event", known, event_of);
  const EnergyTable table(config.events);
  for (const std::string& name : known) {
    if (!table.contains(name)) throw InputError(fmt::format("energy.events: no figure for '{}'", name));
  }
}

void check_unit_names(const EnergyConfig& config, std::span<const UnitReport> units) {
  const Names known = names_of(units), parts = parts_of(units);
  check("energy.logic", config.logic, kNoUnit, known);
  check("energy.flops", config.flops, kNoUnit, known);
  check("energy.parts", config.parts, "no unit has a part of this name", parts);
  check("energy.parts_in_logic", config.parts_in_logic, "no unit has a part of this name", parts);
}

void check_unit_names(const AreaConfig& config, std::span<const UnitReport> units) {
  const Names known = names_of(units);
  check("area.arrays", config.arrays, kNoUnit, known, event_of);
  check("area.buffers", config.buffers, kNoUnit, known);
  check("area.pads", config.pads, kNoUnit, known);
}

}  // namespace sim
