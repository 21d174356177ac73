#pragma once
#include <map>
#include <span>
#include <string>
#include <vector>

#include "sim/config/field.h"
#include "sim/named.h"
#include "sim/report/power.h"
#include "sim/time.h"
#include "sim/unit_report.h"

namespace sim {

/// Figures of a technology: one file of configs/energy.
///
/// An event may depend on the size of the array it accesses: "cache.l1_read@16KiB", "cache.l1_read@32KiB" are points
/// of "cache.l1_read", between and beyond which energy is a power of the size (a straight line on log-log paper).
///
/// `logic` and `flops` say what a unit holds besides SRAM; `parts` is what its logic gains or loses with parts whose
/// number is a key (LogicArea). A unit is looked up as "<block>.<kind>", where its kind is
/// the last part of its path without digits ("core0.tni.trv2" -> "tni.trv"), then as "<block>".
struct EnergyConfig {
  std::string process = "unnamed";
  std::map<std::string, Spread> events;
  Spread clock_share{0, 0, 0};
  Spread sram_leakage{0, 0, 0};
  Spread logic_leakage{0, 0, 0};
  std::map<std::string, Spread> logic;
  std::map<std::string, Spread> parts;
  std::map<std::string, Spread> parts_in_logic;
  Spread flop_clock{0, 0, 0};
  Spread idle_clocked{0, 0, 0};
  std::map<std::string, Spread> flops;

  static void describe(auto& c, auto&& field) {
    const auto energy = [&](auto& value, const char* name, const char* unit, const char* meaning, Limits limits) {
      field(value, name, unit, meaning, limits, Affects::kEnergy);
    };
    energy(NAMED(c.process), "", "what the figures describe", any());
    energy(NAMED(c.events), "pJ", "energy of one event, without its share of the clock tree", at_least(0));
    energy(NAMED(c.clock_share), "", "clock tree's part of a block's dynamic energy", between(0, 0.9));
    energy(NAMED(c.sram_leakage), "mW/KiB", "leakage of storage", at_least(0));
    energy(NAMED(c.logic_leakage), "mW/mm2", "leakage of logic", at_least(0));
    energy(NAMED(c.logic), "mm2", "area of a unit's logic", at_least(0));
    energy(NAMED(c.parts), "mm2", "area of a part of a unit's logic, as tni.trv.box_tester", at_least(0));
    energy(NAMED(c.parts_in_logic), "parts",
           "how many of a part the figure of logic holds; those that a unit has beyond are added to it, those that it "
           "has not are taken off",
           at_least(0));
    energy(NAMED(c.flop_clock), "pJ", "clocking one flip-flop for a cycle", at_least(0));
    energy(NAMED(c.idle_clocked), "", "part of an idle unit's flip-flops that clock gating does not stop",
           between(0, 1));
    energy(NAMED(c.flops), "flops", "flip-flops of a unit", at_least(0));
  }
  void check(auto&& complain) const {
    for (const auto& [name, spread] : events) {
      if (name.find('@') != std::string::npos && spread.low <= 0) {
        complain("events", "'" + name + "' is a point of a curve; allowed: more than 0 pJ");
      }
    }
    for (const auto& [name, count] : parts_in_logic) {
      if (count.low != count.high) complain("parts_in_logic", "'" + name + "' is a band; allowed: one number");
    }
  }
};

/// Energy that a device's own model has worked out, under the name its counters use as event. It includes the device's
/// clock.
struct DeviceEvent {
  Spread pj;             ///< per count
  bool standby = false;  ///< flows whether or not there is work: counted as leakage
};

Spread operator+(const Spread& a, const Spread& b);
Spread operator*(const Spread& a, const Spread& b);
Spread operator*(const Spread& a, double factor);
Spread& operator+=(Spread& a, const Spread& b);

/// Energy by kind, in pJ.
struct EnergyByKind {
  Spread dynamic;
  Spread clock;
  Spread leakage;
  Spread total() const { return dynamic + clock + leakage; }
  EnergyByKind& operator+=(const EnergyByKind& other);
};

/// Where the energy went, in pJ. Both views, by block and by kind, sum to `total_pj`.
struct EnergyReport {
  std::map<std::string, EnergyByKind> blocks;
  /// Energy by block, then by event that its counters name: counts times figures. Standby of devices is leakage; all
  /// others sum to the dynamic energy.
  std::map<std::string, std::map<std::string, Spread>> events;
  EnergyByKind kinds;
  Spread total_pj;
  EnergyReport& operator+=(const EnergyReport& other);
};

/// E_block = sum(count x pJ) / (1 - clock share) + leakage x time + idle clock, where the clock of idle units runs in
/// the cycles they have charged to reasons of the kind kIdle. Device events are taken as they are; all else is times
/// the block's `scales`. Throws InputError for a counter whose event nobody has a figure for, a unit without `logic` or
/// `flops`, or a part that the table does not know.
EnergyReport compute_energy(std::span<const UnitReport> units, const EnergyConfig& config,
                            const std::map<std::string, DeviceEvent>& device_events, Time elapsed,
                            const PowerScales& scales = {});

}  // namespace sim
