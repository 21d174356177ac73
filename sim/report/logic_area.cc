#include "sim/report/logic_area.h"

#include <algorithm>
#include <string>

#include <fmt/format.h>

#include "sim/error.h"
#include "sim/report/unit_entry.h"

namespace sim {
namespace {

const Spread& entry_of(const std::map<std::string, Spread>& table, const UnitReport& unit, const UnitPart& part,
                       const char* key) {
  const std::string own = entry_name(unit) + "." + part.name, of_block = unit.block + "." + part.name;
  for (const std::string& name : {own, of_block}) {
    if (const auto found = table.find(name); found != table.end()) return found->second;
  }
  throw InputError(fmt::format("{}: no entry for part '{}' of unit '{}'; allowed: '{}' or '{}'", key, part.name,
                               unit.path, own, of_block));
}

}  // namespace

LogicArea::LogicArea(const UnitReport& unit, const EnergyConfig& config)
    : logic_(&required_entry(config.logic, unit, "energy.logic")) {
  if (config.parts.empty() && config.parts_in_logic.empty()) return;
  for (const UnitPart& part : unit.parts) {
    const Spread& figure = entry_of(config.parts, unit, part, "energy.parts");
    const double held = entry_of(config.parts_in_logic, unit, part, "energy.parts_in_logic").nominal;
    if (part.count != held) differences_.push_back({part.count - held, &figure});
  }
}

double LogicArea::at(Side side) const {
  double mm2 = logic_->*side;
  for (const Difference& d : differences_) mm2 += d.count * (d.count < 0 ? d.part->nominal : d.part->*side);
  return std::max(0.0, mm2);
}

Spread LogicArea::band() const { return {at(&Spread::low), at(&Spread::nominal), at(&Spread::high)}; }

}  // namespace sim
