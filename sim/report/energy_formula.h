#pragma once
#include <array>
#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "sim/report/energy.h"
#include "sim/report/energy_table.h"
#include "sim/report/logic_area.h"
#include "sim/report/power.h"
#include "sim/time.h"
#include "sim/unit_report.h"

namespace sim {

/// Energy as a formula of the table's values: names are resolved once, then the values may change and the sum be
/// evaluated again. `config` and `device_events` must outlive it and keep their entries.
class EnergyFormula {
 public:
  /// Throws InputError for a counter whose event has no energy, a unit without `logic` or `flops`, or an unknown part.
  EnergyFormula(std::span<const UnitReport> units, const EnergyConfig& config,
                const std::map<std::string, DeviceEvent>& device_events, Time elapsed, const PowerScales& scales = {});

  /// Replaces the counts by others of the same units.
  void recount(std::span<const UnitReport> units, Time elapsed);

  /// Returns low, nominal and high energy by block, kind and event.
  EnergyReport report() const;
  /// Energy of one unit.
  struct UnitEnergy {
    std::vector<Spread>
        events;       ///< one for each counter that names an event, in order, with its share of the clock tree
    Spread standing;  ///< energy independent of activity: leakage, standby, idle clock
  };
  /// In the order of the units. The sum equals report().total_pj except for the order of additions.
  std::vector<UnitEnergy> of_units() const;
  /// pJ of one side by block, in alphabetical order.
  std::vector<double> of_blocks(Side side) const;
  /// pJ of one side by kind.
  std::vector<double> of_kinds(Side side) const;
  static constexpr std::array<const char*, 3> kKinds = {"dynamic", "clock", "leakage"};
  /// pJ of one side, bit-equal to that side of report().total_pj.
  double total(Side side) const;
  const std::vector<std::string>& blocks() const { return blocks_; }

 private:
  /// Energy per count: from the table for arrays of one size, or of a device.
  struct Figure {
    EnergyPoint point{};
    const DeviceEvent* device = nullptr;
    double at(Side side) const { return device != nullptr ? device->pj.*side : point.at(side); }
    friend bool operator==(const Figure&, const Figure&) = default;
  };
  struct Term {
    std::size_t figure;
    double count;
    std::string event;
  };
  struct Unit {
    std::size_t block;
    std::vector<Term> terms;
    double sram_kib, idle_cycles;
    const Spread* flops;
    LogicArea logic;
  };
  /// Energy of one side by kind.
  struct Kinds {
    double dynamic = 0, clock = 0, leakage = 0;
    double total() const { return dynamic + clock + leakage; }
    void add(const Kinds& more);
  };

  Figure figure_of(const UnitReport& unit, const CounterReport& counter,
                   const std::map<std::string, DeviceEvent>& device_events) const;
  std::size_t index_of(const Figure& figure);
  std::vector<double> figures(Side side) const;
  Kinds of(const Unit& unit, const std::vector<double>& figures, Side side) const;

  const EnergyConfig& config_;
  EnergyTable table_;
  std::vector<Figure> figures_;
  std::vector<std::string> blocks_;
  std::vector<PowerScale> scales_;  ///< one per block
  std::vector<Unit> units_;
  double leakage_pj_per_mw_;
};

}  // namespace sim
