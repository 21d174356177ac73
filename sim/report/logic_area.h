#pragma once
#include <vector>

#include "sim/report/energy.h"
#include "sim/report/energy_table.h"
#include "sim/unit_report.h"

namespace sim {

/// Area of a unit's logic, in mm2, as a formula of the figures, which may change:
///
///   energy.logic + sum over the unit's parts ( (count - energy.parts_in_logic) x energy.parts ), not below 0
///
/// What is taken away is taken at its nominal area, of which energy.logic is made: so a smaller unit's band is in
/// order. A part is looked up as "<block>.<kind>.<part>", then as "<block>.<part>". A table that knows no parts at all
/// is that of a report from before there were any: its logic is energy.logic, whatever the unit is built of. `config`
/// must outlive the formula and keep its entries.
class LogicArea {
 public:
  /// Throws InputError for a unit without `logic`, or with a part that the table does not know.
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
