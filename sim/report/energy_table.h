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

/// Energy of an event for one size of memory array: a point of a curve, or a power-law interpolation between two
/// points. The object refers to values in the energy table, which may change later.
struct EnergyPoint {
  const Band* left = nullptr;
  const Band* right = nullptr;  ///< second point; null: the energy is that of `left`
  double part = 0;              ///< position between `left` (0) and `right` (1), in the logarithm of the size
  double energy_of(BandMember member) const;
  friend bool operator==(const EnergyPoint&, const EnergyPoint&) = default;
};

/// Energy in pJ of an event, as a function of the size of the memory array that the event accesses.
class EnergyCurve {
 public:
  bool depends_on_size() const { return points_.size() > 1; }
  /// Returns the energy for an array of `bytes` bytes. `bytes` must be more than 0 if depends_on_size().
  EnergyPoint point_at(std::uint64_t bytes) const;
  /// Smallest and largest array size of the curve's points, in bytes. point_at() extrapolates outside this range.
  std::uint64_t least_bytes() const { return static_cast<std::uint64_t>(points_.front().bytes); }
  std::uint64_t most_bytes() const { return static_cast<std::uint64_t>(points_.back().bytes); }

 private:
  friend class EnergyTable;
  struct Point {
    double bytes;
    const Band* pj;
  };
  /// Points of the energy curve by increasing size of the memory array; a single point of size 0 if the energy does not
  /// depend on the size.
  std::vector<Point> points_;
};

/// Looks up the energy of events in the energy table `events`, which must outlive the EnergyTable and keep its entries.
class EnergyTable {
 public:
  /// Throws InputError for an event with an invalid size ("@16KiB"), and for an event both with and without a size.
  /// `key`: name of the table in error texts.
  explicit EnergyTable(const std::map<std::string, Band>& events, std::string_view key = "energy.events");
  explicit EnergyTable(std::map<std::string, Band>&&,
                       std::string_view = {}) = delete;  // deleted, because this object keeps pointers to the entries

  /// Returns the energy in pJ of an event in a memory array of `bytes` bytes. Requires contains(event).
  Band energy_of(std::string_view event, std::uint64_t bytes) const;
  bool contains(std::string_view event) const { return curves_.contains(std::string(event)); }
  const EnergyCurve& curve_of(std::string_view event) const { return curves_.at(std::string(event)); }
  /// Returns the names of all events in alphabetical order. An event with several sizes ("name@16KiB") appears once
  /// ("name").
  std::vector<std::string> event_names() const;

 private:
  std::map<std::string, EnergyCurve> curves_;
};

/// Returns the event name of an energy table entry, without the size: "cache.l1_read" for "cache.l1_read@16KiB".
inline std::string event_name_of(std::string_view entry) { return std::string(entry.substr(0, entry.find('@'))); }

/// Returns the name of a unit's entry in energy and area tables: "tni.trv" for "core0.tni.trv2" of block "tni".
inline std::string entry_name(const UnitReport& unit) {
  std::string kind = unit.path.substr(unit.path.rfind('.') + 1);
  kind.erase(kind.find_last_not_of("0123456789") + 1);
  return unit.block + "." + kind;
}

/// Returns a unit's entry in an energy or area table: by entry_name(), or else the entry of its block. Null if the
/// table has neither.
template <class Table>
auto find_entry(const Table& table, const UnitReport& unit) -> const typename Table::mapped_type* {
  for (const std::string& name : {entry_name(unit), unit.block}) {
    if (const auto found = table.find(name); found != table.end()) return &found->second;
  }
  return nullptr;
}

/// Returns a unit's entry in an energy or area table. If there is none, throws InputError with the key of the table and
/// both names that were looked up.
const Band& required_entry(const std::map<std::string, Band>& table, const UnitReport& unit, std::string_view key);
/// Throws the InputError of required_entry() for a missing entry.
[[noreturn]] void throw_missing_entry(const UnitReport& unit, std::string_view key);

}  // namespace sim
