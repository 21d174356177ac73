#include "sim/report/energy.h"

#include <set>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "sim/error.h"
#include "sim/report/energy_table.h"

namespace sim {
namespace {

constexpr double kPicojoulesPerMilliwattFemtosecond = 1e-6;

/// "core0.tni.trv2" -> "trv"
std::string kind_of(const std::string& path) {
  std::string kind = path.substr(path.rfind('.') + 1);
  kind.erase(kind.find_last_not_of("0123456789") + 1);
  return kind;
}

/// A unit's own entry, or its block's.
Spread entry_of(const std::map<std::string, Spread>& entries, const UnitReport& unit, std::string_view table) {
  const std::string own = fmt::format("{}.{}", unit.block, kind_of(unit.path));
  for (const std::string& name : {own, unit.block}) {
    if (const auto found = entries.find(name); found != entries.end()) return found->second;
  }
  throw InputError(
      fmt::format("energy.{}: no entry for unit '{}'; allowed: '{}' or '{}'", table, unit.path, own, unit.block));
}

std::uint64_t idle_cycles(const UnitReport& unit) {
  std::uint64_t cycles = 0;
  for (std::size_t i = 0; i < unit.reasons.size(); ++i) {
    if (unit.reasons[i].kind == ReasonKind::kIdle) cycles += unit.why[i].second;
  }
  return cycles;
}

/// Energy of the clock tree for a dynamic energy of 1, if it is `share` of the sum.
Spread clock_factor(const Spread& share) {
  const auto factor = [](double s) { return s / (1 - s); };
  return {factor(share.low), factor(share.nominal), factor(share.high)};
}

class Accountant {
 public:
  Accountant(const EnergyConfig& config, const std::map<std::string, DeviceEvent>& device_events, Time elapsed)
      : config_(config),
        table_(config.events),
        device_events_(device_events),
        clock_factor_(clock_factor(config.clock_share)),
        leakage_pj_per_mw_(static_cast<double>(elapsed) * kPicojoulesPerMilliwattFemtosecond) {}

  /// Sums the energy of a unit; the part of each event is added to `events`.
  EnergyByKind of(const UnitReport& unit, std::map<std::string, Spread>& events) const {
    EnergyByKind sum;
    Spread on_chip;
    for (const CounterReport& counter : unit.counters) {
      if (counter.event.empty()) continue;
      const auto count = static_cast<double>(counter.value);
      const auto device = device_events_.find(counter.event);
      const bool is_device = device != device_events_.end();
      const Spread energy = (is_device ? device->second.pj : figure(unit, counter)) * count;
      (!is_device ? on_chip : device->second.standby ? sum.leakage : sum.dynamic) += energy;
      events[counter.event] += energy;
    }
    sum.dynamic += on_chip;
    sum.clock = on_chip * clock_factor_ + idle_clock(unit);
    sum.leakage += leakage(unit);
    return sum;
  }

 private:
  Spread figure(const UnitReport& unit, const CounterReport& counter) const {
    if (!table_.contains(counter.event)) {
      throw InputError(fmt::format("energy.events: no figure for '{}', which counter '{}' of unit '{}' names",
                                   counter.event, counter.name, unit.path));
    }
    if (unit.cache_bytes == 0 && table_.depends_on_size(counter.event)) {
      throw InputError(fmt::format("energy.events: '{}' depends on the size of an array, and unit '{}' has none",
                                   counter.event, unit.path));
    }
    return table_.at(counter.event, unit.cache_bytes);
  }
  Spread leakage(const UnitReport& unit) const {
    const double kib = static_cast<double>(unit.sram_bytes) / 1024;
    return (config_.sram_leakage * kib + config_.logic_leakage * entry_of(config_.logic, unit, "logic")) *
           leakage_pj_per_mw_;
  }
  Spread idle_clock(const UnitReport& unit) const {
    return config_.flop_clock * config_.idle_clocked * entry_of(config_.flops, unit, "flops") *
           static_cast<double>(idle_cycles(unit));
  }

  const EnergyConfig& config_;
  EnergyTable table_;
  const std::map<std::string, DeviceEvent>& device_events_;
  Spread clock_factor_;
  double leakage_pj_per_mw_;
};

}  // namespace

Spread operator+(const Spread& a, const Spread& b) { return {a.low + b.low, a.nominal + b.nominal, a.high + b.high}; }
Spread operator*(const Spread& a, const Spread& b) { return {a.low * b.low, a.nominal * b.nominal, a.high * b.high}; }
Spread operator*(const Spread& a, double factor) { return a * Spread{factor, factor, factor}; }
Spread& operator+=(Spread& a, const Spread& b) { return a = a + b; }

EnergyReport compute_energy(std::span<const UnitReport> units, const EnergyConfig& config,
                            const std::map<std::string, DeviceEvent>& device_events, Time elapsed) {
  const Accountant accountant(config, device_events, elapsed);
  EnergyReport report;
  for (const UnitReport& unit : units) {
    const EnergyByKind energy = accountant.of(unit, report.events[unit.block]);
    EnergyByKind& block = report.blocks[unit.block];
    for (EnergyByKind* sum : {&block, &report.kinds}) {
      sum->dynamic += energy.dynamic;
      sum->clock += energy.clock;
      sum->leakage += energy.leakage;
    }
  }
  report.total_pj = report.kinds.total();
  return report;
}

void check_energy_events(const EnergyConfig& config, std::span<const std::string> declared) {
  const std::set<std::string> known(declared.begin(), declared.end());
  const EnergyTable table(config.events);
  for (const std::string& name : table.names()) {
    if (!known.contains(name)) {
      throw InputError(
          fmt::format("energy.events.{}: no counter names this event; allowed: {}", name, fmt::join(known, ", ")));
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
