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

/// Selects the low, nominal or high value of a Band.
using BandMember = double Band::*;
inline constexpr std::array<BandMember, 3> kBandMembers = {&Band::low, &Band::nominal, &Band::high};

/// Energy of an event for one size of memory array: interpolated by a power law between two points of a curve, or a
/// single point. Refers to values in the energy table, which may change later.
struct EnergyPoint {
  const Band* left = nullptr;
  const Band* right = nullptr;  ///< null: only `left`
  double part = 0;              ///< position between left and right in the logarithm of the size
  double energy_of(BandMember member) const;
  friend bool operator==(const EnergyPoint&, const EnergyPoint&) = default;
};

/// Energy of an event in pJ as a function of the size of the memory array that it accesses.
class EnergyCurve {
 public:
  bool depends_on_size() const { return points_.size() > 1; }
  /// Returns the energy for an array of `bytes` bytes, more than 0 if depends_on_size().
  EnergyPoint point_at(std::uint64_t bytes) const;
  /// Smallest and largest size of the curve's points, in bytes. point_at() extrapolates beyond them.
  std::uint64_t least_bytes() const { return static_cast<std::uint64_t>(points_.front().bytes); }
  std::uint64_t most_bytes() const { return static_cast<std::uint64_t>(points_.back().bytes); }

 private:
  friend class EnergyTable;
  struct Point {
    double bytes;
    const Band* pj;
  };
  /// Points of the curve by increasing size. If the energy of the event does not depend on the size, a single point of
  /// size 0.
  std::vector<Point> points_;
};

/// Finds the energy of events in the energy table `events`, which must outlive this object and keep its entries.
class EnergyTable {
 public:
  /// Throws InputError for an event with an invalid size ("@16KiB"), and for an event both with and without a size.
  /// `key`: name of the table in errors.
  explicit EnergyTable(const std::map<std::string, Band>& events, std::string_view key = "energy.events");
  explicit EnergyTable(std::map<std::string, Band>&&,
                       std::string_view = {}) = delete;  // the table keeps pointers to the entries

  /// Returns the energy in pJ of an event in a memory array of `bytes` bytes. contains() must be true for the event.
  Band energy_of(std::string_view event, std::uint64_t bytes) const;
  bool contains(std::string_view event) const { return curves_.contains(std::string(event)); }
  const EnergyCurve& curve_of(std::string_view event) const { return curves_.at(std::string(event)); }
  /// Returns the names of all events in alphabetical order; an event with several sizes ("name@16KiB") appears once, as
  /// "name".
  std::vector<std::string> event_names() const;

 private:
  std::map<std::string, EnergyCurve> curves_;
};

/// Returns the event of a table entry, without the size: "cache.l1_read@16KiB" -> "cache.l1_read".
inline std::string event_name_of(std::string_view entry) { return std::string(entry.substr(0, entry.find('@'))); }

/// Returns the name under which a table lists a unit: "core0.tni.trv2" of block "tni" -> "tni.trv".
inline std::string entry_name(const UnitReport& unit) {
  std::string kind = unit.path.substr(unit.path.rfind('.') + 1);
  kind.erase(kind.find_last_not_of("0123456789") + 1);
  return unit.block + "." + kind;
}

/// Returns a unit's entry in a table by unit name, or else the entry of its block; null if the table has neither.
template <class Table>
auto find_entry(const Table& table, const UnitReport& unit) -> const typename Table::mapped_type* {
  for (const std::string& name : {entry_name(unit), unit.block}) {
    if (const auto found = table.find(name); found != table.end()) return &found->second;
  }
  return nullptr;
}

/// Returns a unit's entry in a table. Throws InputError if there is none, with the key of the table and both names
/// under which it was looked up.
const Band& required_entry(const std::map<std::string, Band>& table, const UnitReport& unit, std::string_view key);
/// Throws the InputError of required_entry().
[[noreturn]] void refuse_without_entry(const UnitReport& unit, std::string_view key);

}  // namespace sim
