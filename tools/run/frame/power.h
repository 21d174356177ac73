#pragma once
#include <array>
#include <string>
#include <string_view>
#include <vector>

#include "sim/report/energy.h"
#include "tools/run/frame/load_config.h"

namespace hw {
struct ClockConfig;
}

namespace tools {

/// A clock domain of the chip with its own supply. The memory and its interface have other supplies.
struct ClockDomain {
  std::string_view name;
  sim::Frequency hw::ClockConfig::*clock;
  std::vector<std::string> blocks;  ///< blocks of the energy report in this domain
};
const std::array<ClockDomain, 3>& clock_domains();

/// Returns the voltage that a domain needs for its clock by power.dvfs. Throws InputError without a curve.
double voltage_needed(const RunConfig& config, const ClockDomain& domain);

/// Returns the energy scale factors of each block at the configured voltage and temperature.
sim::PowerScales power_scales(const RunConfig& config);

/// Returns a configuration in which the clocks of `domains` are multiplied by `factor` and each domain has the voltage
/// that its clock needs. `origin`: name of the factor in errors.
RunConfig config_at_clocks(const RunConfig& base, const std::vector<std::string>& domains, double factor,
                           const std::string& origin);

/// Returns the nominal leakage power of the chip, without the memory, in mW. `energy`: energy of a frame that takes
/// `ms` milliseconds.
double chip_leakage_mw(const sim::EnergyReport& energy, double ms);

/// Returns a warning for each clock domain whose clock needs another voltage than that of the energy table or more than
/// power.max_voltage, or whose clock is outside its voltage curve.
std::vector<std::string> power_warnings(const RunConfig& config);

/// Throws InputError for invalid voltage curves, curves of unknown clock domains, and missing curves.
void check_power(const RunConfig& config);

}  // namespace tools
