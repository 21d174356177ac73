#include "sim/report/area.h"

#include <algorithm>

#include <fmt/format.h>

#include "sim/error.h"
#include "sim/report/energy.h"
#include "sim/report/energy_table.h"
#include "sim/report/unit_entry.h"

namespace sim {
namespace {

[[noreturn]] void refuse(const char* table, const UnitReport& unit) {
  throw InputError(
      fmt::format("{}: no entry for unit '{}'; allowed: '{}' or '{}'", table, unit.path, entry_name(unit), unit.block));
}

const Spread& entry_of(const std::map<std::string, Spread>& entries, const UnitReport& unit, const char* table) {
  const Spread* const entry = find_entry(entries, unit);
  if (entry == nullptr) refuse(table, unit);
  return *entry;
}

/// The unit's array, or its share of one that several banks make up.
Spread array_of(const EnergyTable& arrays, const UnitReport& unit) {
  const double share = static_cast<double>(unit.sram_bytes) / static_cast<double>(unit.cache_bytes);
  for (const std::string& name : {entry_name(unit), unit.block}) {
    if (arrays.contains(name)) return arrays.at(name, unit.cache_bytes) * std::min(1.0, share);
  }
  refuse("area.arrays", unit);
}

}  // namespace

Spread AreaOfBlock::total() const { return logic + arrays + buffers + pads; }

AreaReport compute_area(std::span<const UnitReport> units, const std::map<std::string, Spread>& logic,
                        const AreaConfig& config) {
  const EnergyTable arrays(config.arrays, "area.arrays");
  AreaReport report;
  for (const UnitReport& unit : units) {
    AreaOfBlock& block = report.blocks[unit.block];
    block.logic += entry_of(logic, unit, "energy.logic") * config.logic_scale;
    if (unit.cache_bytes != 0) block.arrays += array_of(arrays, unit);
    if (unit.sram_bytes > unit.cache_bytes) {
      const double kib = static_cast<double>(unit.sram_bytes - unit.cache_bytes) / 1024;
      block.buffers += entry_of(config.buffers, unit, "area.buffers") * kib;
    }
    if (const Spread* const pads = find_entry(config.pads, unit)) block.pads += *pads;
  }
  for (const auto& [name, block] : report.blocks) report.total += block.total();
  report.total = report.total * config.placement;
  return report;
}

}  // namespace sim
