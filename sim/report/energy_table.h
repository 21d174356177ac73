#pragma once
#include <array>
#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "sim/config/field.h"
#include "sim/unit_report.h"

namespace sim {

/// Selects low, nominal or high of a value.
using Side = double Band::*;
inline constexpr std::array<Side, 3> kSides = {&Band::low, &Band::nominal, &Band::high};

/// A curve at one size: a power law between two points, or a single point. Refers to the table's values, which may
/// change.
struct EnergyPoint {
  const Band* left = nullptr;
  const Band* right = nullptr;  ///< null: only `left`
  double part = 0;              ///< position between left and right in the logarithm of the size
  double at(Side side) const;
  friend bool operator==(const EnergyPoint&, const EnergyPoint&) = default;
};

/// Energy of an event in pJ over the size of the array that it accesses.
class EnergyCurve {
 public:
  bool depends_on_size() const { return points_.size() > 1; }
  /// `bytes`: size of the array, more than 0 if depends_on_size().
  EnergyPoint at(std::uint64_t bytes) const;
  /// Range of the curve's points; at() extrapolates beyond them.
  std::uint64_t least_bytes() const { return static_cast<std::uint64_t>(points_.front().bytes); }
  std::uint64_t most_bytes() const { return static_cast<std::uint64_t>(points_.back().bytes); }

 private:
  friend class EnergyTable;
  struct Point {
    double bytes;
    const Band* pj;
  };
  /// by increasing size; one point of size 0 if the event does not depend on it
  std::vector<Point> points_;
};

/// Lookup of the events of an EnergyConfig. `events` must outlive the table and keep its entries.
class EnergyTable {
 public:
  /// Throws InputError for an invalid size ("@16KiB"), or an event both with and without a size. `key` names the table
  /// in errors.
  explicit EnergyTable(const std::map<std::string, Band>& events, std::string_view key = "energy.events");
  explicit EnergyTable(std::map<std::string, Band>&&,
                       std::string_view = {}) = delete;  // the table keeps pointers to the entries

  /// Energy of an event in pJ in an array of `bytes`. contains() must be true.
  Band at(std::string_view event, std::uint64_t bytes) const;
  bool contains(std::string_view event) const { return curves_.contains(std::string(event)); }
  const EnergyCurve& curve_of(std::string_view event) const { return curves_.at(std::string(event)); }
  /// Names without sizes, in alphabetical order.
  std::vector<std::string> event_names() const;

 private:
  std::map<std::string, EnergyCurve> curves_;
};

/// "cache.l1_read@16KiB" -> "cache.l1_read"
inline std::string event_of(std::string_view entry) { return std::string(entry.substr(0, entry.find('@'))); }

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
const Band& required_entry(const std::map<std::string, Band>& table, const UnitReport& unit, std::string_view key);
/// Throws the error of required_entry().
[[noreturn]] void refuse_without_entry(const UnitReport& unit, std::string_view key);

}  // namespace sim
