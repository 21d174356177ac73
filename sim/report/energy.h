#pragma once
#include <array>
#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "sim/config/field.h"
#include "sim/named.h"
#include "sim/time.h"
#include "sim/unit_report.h"

namespace sim {

/// Selects the voltage for which energies are computed.
enum class Voltage : std::uint8_t {
  kNominal,  ///< the voltage of the energy table, for any clock frequency
  kDvfs,     ///< the voltage that each clock domain needs for its frequency
};
constexpr std::array<std::string_view, 2> names_of(Voltage) { return {"nominal", "dvfs"}; }

/// Power state of the chip between frames.
enum class ChipIdle : std::uint8_t {
  kPowerGated,  ///< supply off; the fraction `idle_leakage` of the leakage remains
  kClockGated,  ///< supply on, clocks off: all leakage remains
  kClocked,     ///< supply and clocks on: all leakage, and the clock energy of idle units
};
constexpr std::array<std::string_view, 3> names_of(ChipIdle) { return {"power_gated", "clock_gated", "clocked"}; }

/// Operating conditions of the chip, such as voltage and temperature: one file of configs/power. The defaults do not
/// scale energies.
struct PowerConfig {
  std::string process = "unnamed";
  Voltage voltage = Voltage::kNominal;
  std::map<std::string, Band> dvfs;
  double nominal_voltage = 0.8;
  double max_voltage = 5;
  double temperature = 75, nominal_temperature = 75;
  double leakage_exponent = 3;
  double leakage_doubling = 25;
  ChipIdle idle = ChipIdle::kPowerGated;
  double idle_leakage = 0.03;

  static void describe(auto& c, auto&& field) {
    const auto power = [&](auto& value, const char* name, const char* unit, const char* meaning, Limits limits) {
      field(value, name, unit, meaning, limits, Affects::kEnergy);
    };
    power(NAMED(c.process), "", "technology of the table", any());
    power(NAMED(c.voltage), "",
          "voltage used for energies: that of the energy table at any clock, or the one that each clock needs by dvfs",
          any());
    power(NAMED(c.dvfs), "V", "voltage that a clock domain needs for a frequency, as tni@500MHz: points of a curve",
          at_least(0));
    power(NAMED(c.nominal_voltage), "V", "voltage of the energy table", between(0.1, 5));
    power(NAMED(c.max_voltage), "V", "highest voltage that the process allows; a clock that needs more is a warning",
          between(0.1, 5));
    power(NAMED(c.temperature), "C", "temperature of the chip, for leakage", between(-40, 150));
    power(NAMED(c.nominal_temperature), "C", "temperature of the energy table", between(-40, 150));
    power(NAMED(c.leakage_exponent), "", "power of the voltage with which leakage grows", between(0, 20));
    power(NAMED(c.leakage_doubling), "C", "rise of temperature that doubles leakage", between(1, 1000));
    power(NAMED(c.idle), "",
          "state of the chip between frames: without supply, without clocks, or with the clocks of idle units", any());
    power(NAMED(c.idle_leakage), "", "share of the leakage that remains between frames with idle power_gated",
          between(0, 1));
  }
  void check(auto&& complain) const {
    for (const auto& [name, volt] : dvfs) {
      if (volt.low != volt.high || volt.low <= 0) {
        complain("dvfs", "'" + name + "' is no voltage; allowed: one number of volts, more than 0");
      }
    }
  }
};

/// Factors that are applied to the energies of a block from the energy table. Energies of external devices (DRAM) are
/// not scaled.
struct PowerScale {
  double dynamic = 1, leakage = 1;
};
/// Scale factors by block name. Blocks that are absent have factors of 1.
using PowerScales = std::map<std::string, PowerScale>;

/// Voltage of a clock domain as a function of its frequency: linear between points, constant below the lowest point,
/// extrapolated above the highest.
class VoltageCurve {
 public:
  double voltage_at(std::uint64_t hz) const;
  std::uint64_t lowest_hz() const { return points_.front().hz; }
  std::uint64_t highest_hz() const { return points_.back().hz; }

 private:
  friend std::map<std::string, VoltageCurve> voltage_curves(const PowerConfig& config);
  struct Point {
    std::uint64_t hz;
    double volt;
  };
  std::vector<Point> points_;  ///< points of the curve by increasing frequency
};

/// Returns the voltage curve of each clock domain in `config.dvfs`. Throws InputError for an entry without a frequency,
/// or a voltage that decreases with frequency.
std::map<std::string, VoltageCurve> voltage_curves(const PowerConfig& config);

/// Returns the energy factors for a voltage. Dynamic energy grows with the square of the voltage. Leakage grows with a
/// power of the voltage, and doubles every `leakage_doubling` degrees.
PowerScale power_scale(const PowerConfig& config, double volt);

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
  std::uint64_t smallest_array_bytes() const { return static_cast<std::uint64_t>(points_.front().bytes); }
  std::uint64_t largest_array_bytes() const { return static_cast<std::uint64_t>(points_.back().bytes); }

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

/// Energy table of a manufacturing process: one file of configs/energy.
///
/// 1. The energy of an event may depend on the size of the memory array. "cache.l1_read@16KiB" and
/// "cache.l1_read@32KiB" are points of the curve "cache.l1_read", which is a power law between and beyond the points.
/// 2. `logic` (area) and `flops` describe a unit without its SRAM. `parts` corrects `logic` for parts whose number is
/// configured (LogicArea).
/// 3. A unit is looked up by the name "<block>.<kind>", then by "<block>". The kind is the last part of the unit's path
/// without digits: "core0.tni.trv2" is "tni.trv".
struct EnergyConfig {
  std::string process = "unnamed";
  std::map<std::string, Band> events;
  Band clock_share{0, 0, 0};
  Band sram_leakage{0, 0, 0};
  Band logic_leakage{0, 0, 0};
  std::map<std::string, Band> logic;
  std::map<std::string, Band> parts;
  std::map<std::string, Band> parts_in_logic;
  Band flop_clock{0, 0, 0};
  Band idle_clocked{0, 0, 0};
  std::map<std::string, Band> flops;

  static void describe(auto& c, auto&& field) {
    const auto energy = [&](auto& value, const char* name, const char* unit, const char* meaning, Limits limits) {
      field(value, name, unit, meaning, limits, Affects::kEnergy);
    };
    energy(NAMED(c.process), "", "technology of the table", any());
    energy(NAMED(c.events), "pJ", "energy of one event, without its share of the clock tree", at_least(0));
    energy(NAMED(c.clock_share), "", "fraction of a block's dynamic energy that is its clock tree", between(0, 0.9));
    energy(NAMED(c.sram_leakage), "mW/KiB", "leakage of storage", at_least(0));
    energy(NAMED(c.logic_leakage), "mW/mm2", "leakage of logic", at_least(0));
    energy(NAMED(c.logic), "mm2", "area of a unit's logic", at_least(0));
    energy(NAMED(c.parts), "mm2", "area of a part of a unit's logic, as tni.trv.box_tester", at_least(0));
    energy(NAMED(c.parts_in_logic), "parts",
           "number of this part included in logic; additional parts are added, missing ones subtracted", at_least(0));
    energy(NAMED(c.flop_clock), "pJ", "clocking one flip-flop for a cycle", at_least(0));
    energy(NAMED(c.idle_clocked), "", "share of an idle unit's flip-flops that clock gating does not stop",
           between(0, 1));
    energy(NAMED(c.flops), "flops", "flip-flops of a unit", at_least(0));
  }
  void check(auto&& complain) const {
    for (const auto& [name, band] : events) {
      if (name.find('@') != std::string::npos && band.low <= 0) {
        complain("events", "'" + name + "' is a point of a curve; allowed: more than 0 pJ");
      }
    }
    for (const auto& [name, count] : parts_in_logic) {
      if (count.low != count.high) complain("parts_in_logic", "'" + name + "' is a band; allowed: one number");
    }
  }
};

/// Energy of an event that the model of a device, such as DRAM, computes. The energy includes the device's clock.
struct DeviceEvent {
  Band pj;               ///< energy per event
  bool standby = false;  ///< the energy is independent of activity and counted as leakage
};

Band operator+(const Band& a, const Band& b);
Band operator*(const Band& a, const Band& b);
Band operator*(const Band& a, double factor);
Band& operator+=(Band& a, const Band& b);

/// Energy in pJ, split into dynamic energy, clock and leakage.
struct EnergyByKind {
  Band dynamic;
  Band clock;
  Band leakage;
  Band total() const { return dynamic + clock + leakage; }
  EnergyByKind& operator+=(const EnergyByKind& other);
};

/// Energy of a run in pJ. The sums by block and by kind both equal `total_pj`.
struct EnergyReport {
  std::map<std::string, EnergyByKind> blocks;
  /// Energy of each event in each block: number of events times energy per event. Standby events of devices belong to
  /// leakage; all other events sum to the dynamic energy.
  std::map<std::string, std::map<std::string, Band>> events;
  EnergyByKind kinds;
  Band total_pj;
  EnergyReport& operator+=(const EnergyReport& other);
};

/// Computes the energy of each block: sum(count x pJ) / (1 - clock share) + leakage x time + idle clock. A unit uses
/// idle clock energy in cycles charged to reasons of kind kIdle. Factors in `scales` multiply all but device events.
/// Throws InputError if `config` lacks the energy of an event, `logic` or `flops` of a unit, or the area of a part.
EnergyReport compute_energy(std::span<const UnitReport> units, const EnergyConfig& config,
                            const std::map<std::string, DeviceEvent>& device_events, Time elapsed,
                            const PowerScales& scales = {});

/// Area of a unit's logic in mm2, as a formula of values in the energy table. The values may change later:
///
///   energy.logic + sum over the unit's parts ( (count - energy.parts_in_logic) x energy.parts ), at least 0
///
/// 1. Missing parts are subtracted with their nominal area, so that low <= nominal <= high also holds for the result.
/// 2. A part is looked up by the name "<block>.<kind>.<part>", then by "<block>.<part>".
/// 3. If a table has no parts at all, it is from a report of an older version, and the area is energy.logic.
/// 4. `config` must outlive the formula and keep its entries.
class LogicArea {
 public:
  /// Throws InputError if `config` lacks `logic` (area) of the unit, or one of the unit's parts.
  LogicArea(const UnitReport& unit, const EnergyConfig& config);

  double area_of(BandMember member) const;
  Band area_band() const;

 private:
  struct Difference {
    double count;
    const Band* part;
  };
  const Band* logic_;
  std::vector<Difference> differences_;
};

/// Energy of a run as a formula of the values in the energy table. Names are looked up only once, so the energy can be
/// recomputed quickly when values have changed. `config` and `device_events` must outlive the formula and keep their
/// entries.
class EnergyFormula {
 public:
  /// Throws InputError if `config` lacks the energy of an event, `logic` or `flops` of a unit, or the area of a part.
  EnergyFormula(std::span<const UnitReport> units, const EnergyConfig& config,
                const std::map<std::string, DeviceEvent>& device_events, Time elapsed, const PowerScales& scales = {});

  /// Replaces the event counts and times in the energy formula by those of another run of the same units.
  void set_counts(std::span<const UnitReport> units, Time elapsed);

  /// Returns low, nominal and high energy by block, kind and event.
  EnergyReport compute_report() const;
  /// Energy of one unit in pJ.
  struct UnitEnergy {
    std::vector<Band> events;  ///< energy of each counter with an event, with its share of the clock tree
    Band idle;                 ///< energy independent of activity: leakage, standby, idle clock
  };
  /// Returns the energy of each unit, in the order of the units. The sum equals compute_report().total_pj, except for
  /// rounding.
  std::vector<UnitEnergy> unit_energies() const;
  /// Returns the energy of each block in pJ, in alphabetical order of the blocks. `member`: low, nominal or high.
  std::vector<double> block_energies(BandMember member) const;
  /// Returns the total dynamic energy, clock energy and leakage in pJ. `member`: low, nominal or high.
  std::vector<double> kind_energies(BandMember member) const;
  static constexpr std::array<const char*, 3> kKinds = {"dynamic", "clock", "leakage"};
  /// Returns the total energy in pJ, bit-identical to compute_report().total_pj. `member`: low, nominal or high.
  double total_pj(BandMember member) const;
  const std::vector<std::string>& block_names() const { return blocks_; }

 private:
  /// Energy of one kind of event: from the energy table, for a memory array of one size, or from the model of a device.
  struct EventEnergy {
    EnergyPoint point{};
    const DeviceEvent* device = nullptr;
    double energy_of(BandMember member) const {
      return device != nullptr ? device->pj.*member : point.energy_of(member);
    }
    friend bool operator==(const EventEnergy&, const EventEnergy&) = default;
  };
  struct Term {
    std::size_t energy_index;
    double count;
    std::string event;
  };
  struct Unit {
    std::size_t block;
    std::vector<Term> terms;
    double sram_kib, idle_cycles;
    const Band* flops;
    LogicArea logic;
  };
  /// Low, nominal or high energy in pJ, split into dynamic energy, clock and leakage.
  struct Kinds {
    double dynamic = 0, clock = 0, leakage = 0;
    double total() const { return dynamic + clock + leakage; }
    void add(const Kinds& more);
  };

  EventEnergy find_event_energy(const UnitReport& unit, const CounterReport& counter,
                                const std::map<std::string, DeviceEvent>& device_events) const;
  std::size_t index_of(const EventEnergy& energy);
  std::vector<double> pj_per_event(BandMember member) const;
  Kinds unit_kinds(const Unit& unit, const std::vector<double>& pj_per_event, BandMember member) const;

  const EnergyConfig& config_;
  EnergyTable table_;
  std::vector<EventEnergy> event_energies_;
  std::vector<std::string> blocks_;
  std::vector<PowerScale> scales_;  ///< scale factors of each block
  std::vector<Unit> units_;
  double leakage_pj_per_mw_;
};

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

// A table entry that no unit or counter uses is assumed to be misspelt. These functions then throw InputError with the
// nearest known name.

/// Throws InputError unless the events in an energy table are exactly those in `declared`: the events of all counters
/// except the counters of the block "dram".
void check_energy_events(const EnergyConfig& config, std::span<const std::string> declared);

/// Checks that an energy table contains only names of the given units and their parts. Names of units are
/// "<block>.<kind>" or "<block>", those of parts "<block>.<kind>.<part>" or "<block>.<part>". Throws InputError for
/// other names.
void check_unit_names(const EnergyConfig& config, std::span<const UnitReport> units);
void check_unit_names(const AreaConfig& config, std::span<const UnitReport> units);

/// Returns a warning for every kind of unit whose memory array has a size outside its energy or area curve, so that
/// values are extrapolated. `events`: EnergyConfig::events. `arrays`: AreaConfig::arrays; may be empty.
std::vector<std::string> curve_range_warnings(std::span<const UnitReport> units,
                                              const std::map<std::string, Band>& events,
                                              const std::map<std::string, Band>& arrays);

}  // namespace sim
