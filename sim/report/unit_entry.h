#pragma once
#include <map>
#include <string>
#include <string_view>

#include "sim/config/field.h"
#include "sim/unit_report.h"

namespace sim {

/// Returns the name of a unit in a table: "core0.tni.trv2" of block "tni" -> "tni.trv".
inline std::string entry_name(const UnitReport& unit) {
  std::string kind = unit.path.substr(unit.path.rfind('.') + 1);
  kind.erase(kind.find_last_not_of("0123456789") + 1);
  return unit.block + "." + kind;
}

/// Returns a unit's own entry of a table, or its block's; null if there is neither.
template <class Table>
auto find_entry(const Table& table, const UnitReport& unit) -> const typename Table::mapped_type* {
  for (const std::string& name : {entry_name(unit), unit.block}) {
    if (const auto found = table.find(name); found != table.end()) return &found->second;
  }
  return nullptr;
}

/// Returns a unit's entry, or throws InputError with the table's key and both names.
const Spread& required_entry(const std::map<std::string, Spread>& table, const UnitReport& unit, std::string_view key);
/// Throws the error of required_entry().
[[noreturn]] void refuse_without_entry(const UnitReport& unit, std::string_view key);

}  // namespace sim
