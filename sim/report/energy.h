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

/// Energy table of a technology: one file of configs/energy.
///
/// 1. An event may depend on the size of the array: "cache.l1_read@16KiB" and "cache.l1_read@32KiB" are points of the
/// curve "cache.l1_read", a power law between and beyond them.
/// 2. `logic` and `flops` describe a unit without its SRAM; `parts` corrects `logic` for parts whose number is a key
/// (LogicArea).
/// 3. A unit is looked up as "<block>.<kind>", then as "<block>". Its kind is the last part of its path without digits
/// ("core0.tni.trv2" -> "tni.trv").
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

/// Energy of an event that a device's own model computes, including the device's clock.
struct DeviceEvent {
  Spread pj;             ///< per count
  bool standby = false;  ///< independent of activity; counted as leakage
};

Spread operator+(const Spread& a, const Spread& b);
Spread operator*(const Spread& a, const Spread& b);
Spread operator*(const Spread& a, double factor);
Spread& operator+=(Spread& a, const Spread& b);

/// Energy by kind in pJ.
struct EnergyByKind {
  Spread dynamic;
  Spread clock;
  Spread leakage;
  Spread total() const { return dynamic + clock + leakage; }
  EnergyByKind& operator+=(const EnergyByKind& other);
};

/// Energy of a run in pJ. The sums by block and by kind both equal `total_pj`.
struct EnergyReport {
  std::map<std::string, EnergyByKind> blocks;
  /// Energy by block and event: counts times energy per count. Standby of devices is leakage; the others sum to the
  /// dynamic energy.
  std::map<std::string, std::map<std::string, Spread>> events;
  EnergyByKind kinds;
  Spread total_pj;
  EnergyReport& operator+=(const EnergyReport& other);
};

/// Computes E_block = sum(count x pJ) / (1 - clock share) + leakage x time + idle clock. The idle clock runs in cycles
/// charged to reasons of kind kIdle. All but device events is multiplied by the block's `scales`. Throws InputError for
/// a counter whose event has no energy, a unit without `logic` or `flops`, or an unknown part.
EnergyReport compute_energy(std::span<const UnitReport> units, const EnergyConfig& config,
                            const std::map<std::string, DeviceEvent>& device_events, Time elapsed,
                            const PowerScales& scales = {});

}  // namespace sim
