#include "sim/report/energy.h"

#include <algorithm>
#include <set>
#include <string>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "sim/edit_distance.h"
#include "sim/error.h"
#include "sim/report/energy_formula.h"
#include "sim/report/energy_table.h"

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

namespace {

/// ", did you mean 'x'?" for the name nearest to one that is not known, or nothing if all are far off.
std::string nearest(const std::string& name, const std::set<std::string>& known) {
  const std::string_view start = start_of(name);
  const auto found = nearest_of(start, known, std::max<std::size_t>(1, start.size() / 3));
  return found == known.end() ? "" : fmt::format(", did you mean '{}'?", *found);
}

}  // namespace

void check_energy_events(const EnergyConfig& config, std::span<const std::string> declared) {
  const std::set<std::string> known(declared.begin(), declared.end());
  const EnergyTable table(config.events);
  for (const std::string& name : table.names()) {
    if (!known.contains(name)) {
      throw InputError(fmt::format("energy.events.{}: no counter names this event{}; allowed: {}", name,
                                   nearest(name, known), fmt::join(known, ", ")));
    }
  }
  for (const std::string& name : known) {
    if (!table.contains(name)) throw InputError(fmt::format("energy.events: no figure for '{}'", name));
  }
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
