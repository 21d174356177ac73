#include "sim/report/energy.h"

#include <algorithm>
#include <map>
#include <set>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "hw_models/dram/dram_energy.h"
#include "hw_models/machines/gpu_config.h"
#include "tools/run/frame/run_job.h"

// Tests that the energy events which counters name are exactly those with values in the energy files.

namespace test {
namespace {

/// Results of simulating a picture of one tile on the default machine.
struct Played {
  tools::RunConfig config;
  std::vector<sim::UnitReport> units;
  std::map<std::string, sim::DeviceEvent> device;  ///< events whose energy the DRAM model computes
  std::set<std::string> counted;                   ///< events that counters name
};

const Played& played() {
  static const Played once = [] {
    tools::JobOptions options;
    options.resolution = "16x16";
    options.sets = {"render.primary=raster", "tni.predictor.enabled=true",
                    "build.engine=unit"};  // so that there are all units
    const tools::Inputs inputs = tools::load_inputs(options);
    Played p{inputs.config, tools::simulate_frame(inputs, kernels::parse_program("full:1"), 1).units, {}, {}};
    p.device = hw::dram_energy_events(p.config.gpu->dram);
    for (const sim::UnitReport& unit : p.units) {
      for (const sim::CounterReport& counter : unit.counters) {
        if (!counter.event.empty()) p.counted.insert(counter.event);
      }
    }
    return p;
  }();
  return once;
}

TEST(EnergyEvents, OfTheCountersAreThoseOfTheTable) {
  std::vector<std::string> on_chip;
  std::ranges::copy_if(played().counted, std::back_inserter(on_chip),
                       [](const std::string& name) { return !played().device.contains(name); });
  EXPECT_GT(on_chip.size(), 20U);
  EXPECT_NO_THROW(sim::check_energy_events(played().config.energy, on_chip));
}

TEST(EnergyEvents, OfTheMemoryDeviceAreAllCounted) {
  for (const auto& [name, event] : played().device) EXPECT_TRUE(played().counted.contains(name)) << name;
}

TEST(EnergyEvents, OfTheMemoryDeviceAreNotInTheTableToo) {
  for (const auto& [name, event] : played().device) EXPECT_FALSE(played().config.energy.events.contains(name)) << name;
}

TEST(EnergyTable, HasNoUnitThatTheMachineHasNot) {
  std::set<std::string> kinds;
  for (const sim::UnitReport& unit : played().units) {
    std::string kind = unit.path.substr(unit.path.rfind('.') + 1);
    kind.erase(kind.find_last_not_of("0123456789") + 1);
    kinds.insert({unit.block, unit.block + "." + kind});
  }
  for (const auto* table : {&played().config.energy.logic, &played().config.energy.flops}) {
    for (const auto& [name, figure] : *table) EXPECT_TRUE(kinds.contains(name)) << name;
  }
}

TEST(EnergyTable, HasThePartsOfTheMachinesUnitsAndNoOthers) {
  std::set<std::string> parts;
  for (const sim::UnitReport& unit : played().units) {
    for (const sim::UnitPart& part : unit.parts) parts.insert(sim::entry_name(unit) + "." + part.name);
  }
  EXPECT_EQ(parts.size(), 12U);
  for (const auto* table : {&played().config.energy.parts, &played().config.energy.parts_in_logic}) {
    std::set<std::string> names;
    for (const auto& [name, figure] : *table) names.insert(name);
    // Parts of the shader core are named after its area block, as its logic is.
    std::set<std::string> known;
    for (std::string part : parts) known.insert(part.starts_with("srp.srp.") ? part.substr(4) : part);
    EXPECT_EQ(names, known);
  }
}

TEST(EnergyTable, HasTheDefaultMachinesLogicAsItIs) {
  for (const sim::UnitReport& unit : played().units) {
    EXPECT_EQ(sim::LogicArea(unit, played().config.energy).area_band(),
              sim::required_entry(played().config.energy.logic, unit, "logic"))
        << unit.path;
  }
}

}  // namespace
}  // namespace test
