#pragma once
#include <map>
#include <string>

#include "hw_models/dram/dram_channel.h"
#include "hw_models/dram/dram_config.h"
#include "sim/report/energy.h"

namespace hw {

/// Returns the energy of each kind of event that a DRAM channel counts. A burst's energy includes the DRAM array, the
/// pins and the GPU's PHY. A standby cycle's energy is the background power of one rank times the command clock period.
std::map<std::string, sim::DeviceEvent> dram_energy_events(const DramConfig& config);

/// Returns the power of the whole DRAM between frames, in mW.
sim::Band dram_idle_power_mw(const DramConfig& config);

/// Returns the total energy of the events counted by a DRAM channel, in pJ.
sim::Band dram_energy(const DramConfig& config, const DramChannel::Stats& stats);

}  // namespace hw
