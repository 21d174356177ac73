#pragma once
#include <map>
#include <span>
#include <string>

#include "sim/config/field.h"
#include "sim/named.h"
#include "sim/report/energy.h"
#include "sim/unit_report.h"

namespace sim {

/// Area table of a manufacturing process: one file of configs/area. Areas of logic are in EnergyConfig (LogicArea),
/// because they also determine leakage. `logic_scale` converts them to this process.
///
/// 1. The area of a memory array depends on its size. "l2@64KiB" and "l2@256KiB" are points of the curve "l2", which is
/// a power law between and beyond the points.
/// 2. A unit is looked up by the name "<block>.<kind>", then by "<block>".
struct AreaConfig {
  std::string process = "unnamed";
  Band logic_scale{1, 1, 1};
  std::map<std::string, Band> arrays;
  std::map<std::string, Band> buffers;
  std::map<std::string, Band> pads;
  Band placement{1, 1, 1};

  static void describe(auto& c, auto&& field) {
    const auto area = [&](auto& value, const char* name, const char* unit, const char* meaning) {
      field(value, name, unit, meaning, at_least(0), Affects::kEnergy);
    };
    area(NAMED(c.process), "", "technology of the table");
    area(NAMED(c.logic_scale), "", "area of logic in this process relative to energy.logic");
    area(NAMED(c.arrays), "mm2", "the array of a unit whose accesses are counted, by size");
    area(NAMED(c.buffers), "mm2/KiB", "storage of a unit in addition to that array");
    area(NAMED(c.pads), "mm2", "drivers, receivers and pads of a unit at the die's edge, for each 16 data lines");
    area(NAMED(c.placement), "", "die area relative to the sum of its blocks, for wires and gaps");
  }
};

/// Area of one block of the chip, in mm2.
struct AreaOfBlock {
  Band logic, arrays, buffers, pads;
  Band total() const;
};

struct AreaReport {
  std::map<std::string, AreaOfBlock> blocks;
  Band total;  ///< area of all blocks, plus wires between them and gaps
};

/// Computes the area of each block of the chip. `energy`: table with the areas of logic. Throws InputError for a unit
/// whose block, memory or part is not in the tables.
AreaReport compute_area(std::span<const UnitReport> units, const EnergyConfig& energy, const AreaConfig& config);

}  // namespace sim
