#include "tools/run/frame/table_names.h"

#include <string>
#include <vector>

#include "hw_models/memory/unit_names.h"
#include "hw_models/raster/raster_unit.h"
#include "sim/report/table_checks.h"

namespace tools {
namespace {

/// The rasteriser of a frame that does not use one: its table entries are still valid.
sim::UnitReport absent_rasteriser() {
  sim::UnitReport unit;
  unit.path = hw::name_in_core(hw::RasterUnit::kName, 0);
  unit.block = names_of(hw::Block{})[static_cast<std::size_t>(hw::RasterUnit::kBlock)];
  const hw::RasterUnit::Stats none;
  hw::RasterUnit::Stats::describe(none, [&](const std::uint64_t& value, const char* name, const char* meaning,
                                            const char* event = "", sim::CounterKind kind = sim::CounterKind::kSum) {
    unit.counters.push_back({name, meaning, value, event, kind});
  });
  return unit;
}

}  // namespace

void check_table_names(std::span<const sim::UnitReport> units, const RunConfig& config) {
  std::vector<sim::UnitReport> all(units.begin(), units.end());
  all.push_back(absent_rasteriser());
  std::vector<std::string> declared;
  for (const sim::UnitReport& unit : all) {
    for (const sim::CounterReport& counter : unit.counters) {
      if (unit.block != "dram" && !counter.event.empty()) declared.push_back(counter.event);
    }
  }
  sim::check_energy_events(config.energy, declared);
  sim::check_unit_names(config.energy, all);
  sim::check_unit_names(config.area, all);
}

}  // namespace tools
