#pragma once
#include <vector>

#include "sim/report/energy.h"
#include "sim/report/energy_table.h"
#include "sim/unit_report.h"

namespace sim {

/// Area of a unit's logic in mm2, as a formula of the table's values, which may change:
///
///   energy.logic + sum over the unit's parts ( (count - energy.parts_in_logic) x energy.parts ), at least 0
///
/// 1. Removed parts count with their nominal area, so the band of a smaller unit stays in order.
/// 2. A part is looked up as "<block>.<kind>.<part>", then as "<block>.<part>".
/// 3. A table without any parts is from a report of an older version: the area is energy.logic.
/// 4. `config` must outlive the formula and keep its entries.
class LogicArea {
 public:
  /// Throws InputError for a unit without `logic` or with an unknown part.
  LogicArea(const UnitReport& unit, const EnergyConfig& config);

  double at(Side side) const;
  Spread band() const;

 private:
  struct Difference {
    double count;
    const Spread* part;
  };
  const Spread* logic_;
  std::vector<Difference> differences_;
};

}  // namespace sim
