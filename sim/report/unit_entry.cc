#include "sim/report/unit_entry.h"

#include <fmt/format.h>

#include "sim/error.h"

namespace sim {

const Spread& required_entry(const std::map<std::string, Spread>& table, const UnitReport& unit, std::string_view key) {
  if (const Spread* const entry = find_entry(table, unit)) return *entry;
  refuse_without_entry(unit, key);
}

void refuse_without_entry(const UnitReport& unit, std::string_view key) {
  throw InputError(
      fmt::format("{}: no entry for unit '{}'; allowed: '{}' or '{}'", key, unit.path, entry_name(unit), unit.block));
}

}  // namespace sim
