#include "sim/report/area.h"

#include <algorithm>

#include <fmt/format.h>

#include "sim/error.h"
#include "sim/report/energy.h"

namespace sim {
namespace {

/// Returns the area of a unit's memory array. If several units share an array as its banks, returns the unit's share.
Band array_area_of(const EnergyTable& arrays, const UnitReport& unit) {
  const double share = static_cast<double>(unit.sram_bytes) / static_cast<double>(unit.cache_bytes);
  for (const std::string& name : {entry_name(unit), unit.block}) {
    if (arrays.contains(name)) return arrays.energy_of(name, unit.cache_bytes) * std::min(1.0, share);
  }
  throw_missing_entry(unit, "area.arrays");
}

/// Returns the area of a unit's pads, in proportion to its data pins. `area`: entry of the area table, for 16 pins.
Band pad_area_of(const Band& area, const UnitReport& unit) {
  if (unit.data_lines != 0) return area * (static_cast<double>(unit.data_lines) / 16);
  throw InputError(fmt::format("area.pads: unit '{}' has no data lines at the die's edge", unit.path));
}

}  // namespace

Band AreaOfBlock::total() const { return logic + arrays + buffers + pads; }

AreaReport compute_area(std::span<const UnitReport> units, const EnergyConfig& energy, const AreaConfig& config) {
  const EnergyTable arrays(config.arrays, "area.arrays");
  AreaReport report;
  for (const UnitReport& unit : units) {
    AreaOfBlock& block = report.blocks[unit.block];
    block.logic += LogicArea(unit, energy).area_band() * config.logic_scale;
    if (unit.cache_bytes != 0) block.arrays += array_area_of(arrays, unit);
    if (unit.sram_bytes > unit.cache_bytes) {
      const double kib = static_cast<double>(unit.sram_bytes - unit.cache_bytes) / 1024;
      block.buffers += required_entry(config.buffers, unit, "area.buffers") * kib;
    }
    if (const Band* const pads = find_entry(config.pads, unit)) block.pads += pad_area_of(*pads, unit);
  }
  for (const auto& [name, block] : report.blocks) report.total += block.total();
  report.total = report.total * config.placement;
  return report;
}

}  // namespace sim
