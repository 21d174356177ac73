#pragma once
#include <map>
#include <string>

#include "hw_models/dram/dram_channel.h"
#include "hw_models/dram/dram_config.h"
#include "sim/report/energy.h"

namespace hw {

/// Energy of each event that DramChannel counts. A burst includes the device's core, the pins and the GPU's PHY; a
/// standby cycle is the background power of one rank for one cycle of its command clock.
std::map<std::string, sim::DeviceEvent> dram_energy_events(const DramConfig& config);

/// Energy of a channel for all that it counted, in pJ.
sim::Spread dram_energy(const DramConfig& config, const DramChannel::Stats& stats);

}  // namespace hw
