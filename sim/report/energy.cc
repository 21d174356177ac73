#include "sim/report/energy.h"

#include "sim/report/energy_formula.h"

namespace sim {

Spread operator+(const Spread& a, const Spread& b) { return {a.low + b.low, a.nominal + b.nominal, a.high + b.high}; }
Spread operator*(const Spread& a, const Spread& b) { return {a.low * b.low, a.nominal * b.nominal, a.high * b.high}; }
Spread operator*(const Spread& a, double factor) { return a * Spread{factor, factor, factor}; }
Spread& operator+=(Spread& a, const Spread& b) { return a = a + b; }

EnergyReport compute_energy(std::span<const UnitReport> units, const EnergyConfig& config,
                            const std::map<std::string, DeviceEvent>& device_events, Time elapsed,
                            const PowerScales& scales) {
  return EnergyFormula(units, config, device_events, elapsed, scales).report();
}

EnergyByKind& EnergyByKind::operator+=(const EnergyByKind& other) {
  dynamic += other.dynamic;
  clock += other.clock;
  leakage += other.leakage;
  return *this;
}

EnergyReport& EnergyReport::operator+=(const EnergyReport& other) {
  for (const auto& [name, energy] : other.blocks) blocks[name] += energy;
  for (const auto& [block, more] : other.events) {
    for (const auto& [event, energy] : more) events[block][event] += energy;
  }
  kinds += other.kinds;
  total_pj += other.total_pj;
  return *this;
}

}  // namespace sim
