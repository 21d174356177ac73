#pragma once
#include <map>
#include <string>
#include <string_view>

#include "sim/config/field.h"
#include "sim/unit_report.h"

namespace sim {

/// "core0.tni.trv2" of block "tni" -> "tni.trv": what a table calls the unit if it does not go by its block.
inline std::string entry_name(const UnitReport& unit) {
  std::string kind = unit.path.substr(unit.path.rfind('.') + 1);
  kind.erase(kind.find_last_not_of("0123456789") + 1);
  return unit.block + "." + kind;
}

/// A unit's own entry of a table, or its block's; null if there is neither.
template <class Table>
auto find_entry(const Table& table, const UnitReport& unit) -> const typename Table::mapped_type* {
  for (const std::string& name : {entry_name(unit), unit.block}) {
    if (const auto found = table.find(name); found != table.end()) return &found->second;
  }
  return nullptr;
}

/// Entry of a table that must have one. InputError, with the table's key and both names, if there is neither.
const Spread& required_entry(const std::map<std::string, Spread>& table, const UnitReport& unit, std::string_view key);
/// The refusal that required_entry() throws.
[[noreturn]] void refuse_without_entry(const UnitReport& unit, std::string_view key);

}  // namespace sim
