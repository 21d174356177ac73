#include "tools/simulation/energy_events.h"

#include <string>
#include <vector>

#include "hw_models/raster/raster_unit.h"

namespace tools {

void check_energy_events(std::span<const sim::UnitReport> units, const sim::EnergyConfig& config) {
  std::vector<std::string> declared;
  for (const sim::UnitReport& unit : units) {
    for (const sim::CounterReport& counter : unit.counters) {
      if (unit.block != "dram" && !counter.event.empty()) declared.push_back(counter.event);
    }
  }
  // Frames without work for a rasteriser have none, but its figures stand in the table all the same.
  hw::RasterUnit::Stats::describe(hw::RasterUnit::Stats{},
                                  [&](const std::uint64_t&, const char*, const char*, const char* event = "") {
                                    if (*event != 0) declared.emplace_back(event);
                                  });
  sim::check_energy_events(config, declared);
}

}  // namespace tools
