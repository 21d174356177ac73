#pragma once
#include <map>
#include <string>

#include "hw_models/dram/dram_channel.h"
#include "hw_models/dram/dram_config.h"
#include "sim/report/energy.h"

namespace hw {

/// Returns the energy of each event that a DRAM channel counts. The energy of a burst includes the device's core, the
/// pins and the GPU's PHY. The energy of a standby cycle is one rank's background power for one cycle of the command
/// clock.
std::map<std::string, sim::DeviceEvent> dram_energy_events(const DramConfig& config);

/// Returns the power of the whole memory between frames, in mW.
sim::Band dram_idle_mw(const DramConfig& config);

/// Returns the energy of all events that a DRAM channel counted, in pJ.
sim::Band dram_energy(const DramConfig& config, const DramChannel::Stats& stats);

}  // namespace hw
