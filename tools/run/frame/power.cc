#include "tools/run/frame/power.h"

#include <algorithm>
#include <cmath>
#include <map>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "hw_models/machines/gpu_config.h"
#include "sim/config/quantity.h"
#include "sim/error.h"
#include "sim/io/printable.h"
#include "traces/scene/did_you_mean.h"

namespace tools {
namespace {

using Curves = std::map<std::string, sim::VoltageCurve>;

const sim::VoltageCurve& curve_of(const Curves& curves, const ClockDomain& domain) {
  const auto found = curves.find(std::string(domain.name));
  if (found != curves.end()) return found->second;
  throw sim::InputError(
      fmt::format("power.dvfs: no voltages of clock domain '{0}'; allowed: points such as "
                  "{0}@500MHz, as in power.extends=power/14nm",
                  domain.name));
}

std::string clock_text(std::uint64_t hz) { return sim::quantity_text(hz, sim::frequency_units()); }

/// Relative difference due to rounding, below which two voltages count as equal.
constexpr double kVoltRounding = 1e-9;

}  // namespace

const std::array<ClockDomain, 3>& clock_domains() {
  static const std::array<ClockDomain, 3> domains = {{{"tni", &hw::ClockConfig::tni, {"tni", "raster", "build"}},
                                                      {"srp", &hw::ClockConfig::srp, {"srp", "tile_buffer", "dma"}},
                                                      {"l2", &hw::ClockConfig::l2, {"l2", "interconnect"}}}};
  return domains;
}

double voltage_needed(const RunConfig& config, const ClockDomain& domain) {
  return curve_of(sim::voltage_curves(config.power), domain).voltage_at((config.gpu->clocks.*domain.clock).hz);
}

sim::PowerScales power_scales(const RunConfig& config) {
  sim::PowerScales scales;
  const double nominal = config.power.nominal_voltage;
  for (const ClockDomain& domain : clock_domains()) {
    const bool scaled = config.power.voltage == sim::Voltage::kDvfs;
    const double volt = scaled ? voltage_needed(config, domain) : nominal;
    for (const std::string& block : domain.blocks) scales[block] = sim::power_scale(config.power, volt);
  }
  scales["dram"] = sim::power_scale(config.power, nominal);
  return scales;
}

RunConfig config_at_clocks(const RunConfig& base, const std::vector<std::string>& domains, double factor,
                           const std::string& origin) {
  RunConfig config = base;
  config.power.voltage = sim::Voltage::kDvfs;
  for (const ClockDomain& domain : clock_domains()) {
    if (std::ranges::find(domains, domain.name) == domains.end()) continue;
    std::uint64_t& hz = (config.gpu->clocks.*domain.clock).hz;
    hz = static_cast<std::uint64_t>(std::llround(static_cast<double>(hz) * factor));
  }
  check_run_config(config, origin);
  return config;
}

double chip_leakage_mw(const sim::EnergyReport& energy, double ms) {
  constexpr double kPicojoulesPerMicrojoule = 1e6;  // 1 uJ/ms = 1 mW
  double pj = 0;
  for (const ClockDomain& domain : clock_domains()) {
    for (const std::string& block : domain.blocks) {
      const auto of_block = energy.blocks.find(block);  // a machine may have no rasteriser or builder
      if (of_block != energy.blocks.end()) pj += of_block->second.leakage.nominal;
    }
  }
  return pj / kPicojoulesPerMicrojoule / ms;
}

std::vector<std::string> power_warnings(const RunConfig& config) {
  std::vector<std::string> lines;
  const Curves curves = sim::voltage_curves(config.power);
  const double nominal = config.power.nominal_voltage;
  for (const ClockDomain& domain : clock_domains()) {
    const auto found = curves.find(std::string(domain.name));
    if (found == curves.end()) continue;
    const sim::VoltageCurve& curve = found->second;
    const std::uint64_t hz = (config.gpu->clocks.*domain.clock).hz;
    const double volt = curve.voltage_at(hz);
    if (volt > config.power.max_voltage) {
      lines.push_back(fmt::format(
          "power.max_voltage: clocks.{} of {} needs {:.4g} V, more than the {:.4g} V that {} "
          "allows: no such chip reaches this clock",
          domain.name, clock_text(hz), volt, config.power.max_voltage, sim::printable(config.power.process)));
    }
    if (config.power.voltage == sim::Voltage::kDvfs) {
      if (hz >= curve.lowest_hz() && hz <= curve.highest_hz()) continue;
      lines.push_back(fmt::format("power.dvfs: clocks.{} of {} is outside {} to {}; {:.4g} V is assumed", domain.name,
                                  clock_text(hz), clock_text(curve.lowest_hz()), clock_text(curve.highest_hz()), volt));
    } else if (std::abs(volt - nominal) > kVoltRounding * nominal) {
      lines.push_back(
          fmt::format("power.dvfs: clocks.{} of {} needs {:.4g} V, but energies are for {:.4g} V, the voltage of "
                      "the energy table; power.voltage=dvfs scales them",
                      domain.name, clock_text(hz), volt, nominal));
    }
  }
  return lines;
}

void check_power(const RunConfig& config) {
  const Curves curves = sim::voltage_curves(config.power);
  std::vector<std::string> known;
  for (const ClockDomain& domain : clock_domains()) known.emplace_back(domain.name);
  for (const auto& [name, curve] : curves) {
    if (std::ranges::find(known, name) != known.end()) continue;
    throw sim::InputError(fmt::format("power.dvfs: no clock domain is called '{}'{}; allowed: {}", name,
                                      traces::did_you_mean(name, known), fmt::join(known, ", ")));
  }
  power_scales(config);
}

}  // namespace tools
