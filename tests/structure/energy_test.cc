#include "sim/report/energy.h"

#include <algorithm>
#include <map>
#include <set>

#include <gtest/gtest.h>

#include "hw_models/memory/dram_energy.h"
#include "tools/run_job.h"

// What counters name as their energy events, and what the energy files have figures for, is the same set.

namespace test {
namespace {

/// The default machine with a picture of one tile played on it.
const tools::Simulation& simulation(const tools::RunConfig& config) {
  static const tools::Simulation simulated = [&] {
    tools::JobOptions options;
    options.resolution = "16x16";
    tools::Inputs inputs = tools::load_inputs(options);
    inputs.config = config;
    return tools::simulate(inputs, kernels::parse_program("full:1"), 1);
  }();
  return simulated;
}

struct Events {
  tools::RunConfig config;
  std::map<std::string, sim::DeviceEvent> device;  ///< what the DRAM model has worked out
  std::set<std::string> declared;                  ///< what counters name
  Events() {
    tools::JobOptions options;
    options.resolution = "16x16";
    config = tools::load_run_config(options);
    device = hw::dram_energy_events(config.gpu.dram);
    for (const sim::UnitReport& unit : simulation(config).units) {
      for (const sim::CounterReport& counter : unit.counters) {
        if (!counter.event.empty()) declared.insert(counter.event);
      }
    }
  }
};

TEST(EnergyEvents, OfTheCountersAreThoseOfTheTable) {
  const Events events;
  std::vector<std::string> on_chip;
  std::ranges::copy_if(events.declared, std::back_inserter(on_chip),
                       [&](const std::string& name) { return !events.device.contains(name); });
  EXPECT_GT(on_chip.size(), 20U);
  EXPECT_NO_THROW(sim::check_energy_events(events.config.energy, on_chip));
}

TEST(EnergyEvents, OfTheMemoryDeviceAreAllCounted) {
  const Events events;
  for (const auto& [name, event] : events.device) EXPECT_TRUE(events.declared.contains(name)) << name;
}

TEST(EnergyEvents, OfTheMemoryDeviceAreNotInTheTableToo) {
  const Events events;
  for (const auto& [name, event] : events.device) EXPECT_FALSE(events.config.energy.events.contains(name)) << name;
}

TEST(EnergyTable, HasNoUnitThatTheMachineHasNot) {
  const Events events;
  std::set<std::string> kinds;
  for (const sim::UnitReport& unit : simulation(events.config).units) {
    std::string kind = unit.path.substr(unit.path.rfind('.') + 1);
    kind.erase(kind.find_last_not_of("0123456789") + 1);
    kinds.insert({unit.block, unit.block + "." + kind});
  }
  for (const auto* table : {&events.config.energy.logic, &events.config.energy.flops}) {
    for (const auto& [name, figure] : *table) EXPECT_TRUE(kinds.contains(name)) << name;
  }
}

}  // namespace
}  // namespace test
