#include "hw_models/dram/dram_energy.h"

namespace hw {

std::map<std::string, sim::DeviceEvent> dram_energy_events(const DramConfig& config) {
  const DramEnergy& e = config.energy;
  const double cycle_ns = static_cast<double>(config.timing.ck.time) * 1e-6;  // mW x ns = pJ
  return {
      {"dram.activate", {e.activate}},
      {"dram.read_burst", {e.read_core + e.read_io + e.phy}},
      {"dram.write_burst", {e.write_core + e.write_io + e.phy}},
      {"dram.refresh", {e.refresh}},
      {"dram.refresh_all", {e.refresh_all}},
      {"dram.active_standby", {e.active_standby * cycle_ns, true}},
      {"dram.precharge_standby", {e.precharge_standby * cycle_ns, true}},
      {"dram.power_down", {e.power_down_standby * cycle_ns, true}},
  };
}

sim::Band dram_idle_power_mw(const DramConfig& config) {
  const double ranks = double{1} * config.channels * config.organisation.ranks;
  const double refreshed = config.idle == DramIdle::kSelfRefresh ? config.refreshed_part : 0;
  return (config.energy.power_down_standby + config.energy.self_refresh_array * refreshed) * ranks;
}

sim::Band dram_energy(const DramConfig& config, const DramChannel::Stats& stats) {
  const auto events = dram_energy_events(config);
  sim::Band sum;
  DramChannel::Stats::describe(stats,
                               [&](std::uint64_t count, const char*, const char*, const char* event = "", auto&&...) {
                                 if (*event != 0) sum += events.at(event).pj * static_cast<double>(count);
                               });
  return sum;
}

}  // namespace hw
