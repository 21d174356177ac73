#pragma once
#include <array>
#include <string>
#include <string_view>
#include <vector>

#include "sim/report/power.h"
#include "tools/run/frame/load_config.h"

namespace hw {
struct ClockConfig;
}

namespace tools {

/// A clock domain of the chip. Each has a supply of its own; the memory and its interface have theirs.
struct ClockDomain {
  std::string_view name;
  sim::Frequency hw::ClockConfig::*clock;
  std::vector<std::string> blocks;  ///< blocks of the energy report that run on it
};
const std::array<ClockDomain, 3>& clock_domains();

/// Voltage that a domain needs for its clock by power.dvfs. InputError if that says nothing of the domain.
double voltage_needed(const RunConfig& config, const ClockDomain& domain);

/// Factors of each block's energies under the configuration's voltage and temperature.
sim::PowerScales power_scales(const RunConfig& config);

/// A line for each clock whose energies are told at a voltage that it does not have, or that lies outside its curve.
std::vector<std::string> power_warnings(const RunConfig& config);

/// Throws InputError for curves that are none, or of domains that there are not, or that are asked for and missing.
void check_power(const RunConfig& config);

}  // namespace tools
