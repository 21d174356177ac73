#pragma once
#include <array>
#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "sim/config/field.h"
#include "sim/named.h"
#include "sim/report/energy_table.h"
#include "sim/report/power.h"
#include "sim/time.h"
#include "sim/unit_report.h"

namespace sim {

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

}  // namespace sim
