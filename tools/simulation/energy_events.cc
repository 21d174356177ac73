#include "tools/simulation/energy_events.h"

#include <string>
#include <vector>

namespace tools {

void check_energy_events(std::span<const sim::UnitReport> units, const sim::EnergyConfig& config) {
  std::vector<std::string> declared;
  for (const sim::UnitReport& unit : units) {
    for (const sim::CounterReport& counter : unit.counters) {
      if (unit.block != "dram" && !counter.event.empty()) declared.push_back(counter.event);
    }
  }
  sim::check_energy_events(config, declared);
}

}  // namespace tools
