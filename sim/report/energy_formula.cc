#include "sim/report/energy_formula.h"

#include <algorithm>
#include <cassert>
#include <set>

#include <fmt/format.h>

#include "sim/error.h"
#include "sim/report/unit_entry.h"

namespace sim {
namespace {

double leakage_pj_per_mw(Time elapsed) {
  constexpr double kPicojoulesPerMilliwattFemtosecond = 1e-6;
  return static_cast<double>(elapsed) * kPicojoulesPerMilliwattFemtosecond;
}

std::uint64_t idle_cycles(const UnitReport& unit) {
  std::uint64_t cycles = 0;
  for (std::size_t i = 0; i < unit.reasons.size(); ++i) {
    if (unit.reasons[i].kind == ReasonKind::kIdle) cycles += unit.why[i].second;
  }
  return cycles;
}

std::vector<std::string> blocks_of(std::span<const UnitReport> units) {
  std::set<std::string> blocks;
  for (const UnitReport& unit : units) blocks.insert(unit.block);
  return {blocks.begin(), blocks.end()};
}

}  // namespace

void EnergyFormula::Kinds::add(const Kinds& more) {
  dynamic += more.dynamic;
  clock += more.clock;
  leakage += more.leakage;
}

EnergyFormula::EnergyFormula(std::span<const UnitReport> units, const EnergyConfig& config,
                             const std::map<std::string, DeviceEvent>& device_events, Time elapsed,
                             const PowerScales& scales)
    : config_(config),
      table_(config.events),
      blocks_(blocks_of(units)),
      leakage_pj_per_mw_(leakage_pj_per_mw(elapsed)) {
  for (const std::string& block : blocks_) {
    const auto scale = scales.find(block);
    scales_.push_back(scale == scales.end() ? PowerScale{} : scale->second);
  }
  for (const UnitReport& unit : units) {
    const auto block = static_cast<std::size_t>(std::ranges::lower_bound(blocks_, unit.block) - blocks_.begin());
    Unit of{block,
            {},
            static_cast<double>(unit.sram_bytes) / 1024,
            static_cast<double>(idle_cycles(unit)),
            &required_entry(config.flops, unit, "energy.flops"),
            LogicArea(unit, config)};
    for (const CounterReport& counter : unit.counters) {
      if (counter.event.empty()) continue;
      of.terms.push_back(
          {index_of(figure_of(unit, counter, device_events)), static_cast<double>(counter.value), counter.event});
    }
    units_.push_back(std::move(of));
  }
}

void EnergyFormula::recount(std::span<const UnitReport> units, Time elapsed) {
  assert(units.size() == units_.size());
  leakage_pj_per_mw_ = leakage_pj_per_mw(elapsed);
  for (std::size_t u = 0; u < units.size(); ++u) {
    units_[u].idle_cycles = static_cast<double>(idle_cycles(units[u]));
    auto term = units_[u].terms.begin();
    for (const CounterReport& counter : units[u].counters) {
      if (!counter.event.empty()) (term++)->count = static_cast<double>(counter.value);
    }
  }
}

EnergyFormula::Figure EnergyFormula::figure_of(const UnitReport& unit, const CounterReport& counter,
                                               const std::map<std::string, DeviceEvent>& device_events) const {
  if (const auto device = device_events.find(counter.event); device != device_events.end()) {
    return {.device = &device->second};
  }
  if (!table_.contains(counter.event)) {
    throw InputError(fmt::format("energy.events: no figure for '{}', which counter '{}' of unit '{}' names",
                                 counter.event, counter.name, unit.path));
  }
  const EnergyCurve& curve = table_.curve(counter.event);
  if (unit.cache_bytes == 0 && curve.depends_on_size()) {
    throw InputError(fmt::format("energy.events: '{}' depends on the size of an array, and unit '{}' has none",
                                 counter.event, unit.path));
  }
  return {.point = curve.at(unit.cache_bytes)};
}

std::size_t EnergyFormula::index_of(const Figure& figure) {
  const auto known = std::ranges::find(figures_, figure);
  if (known != figures_.end()) return static_cast<std::size_t>(known - figures_.begin());
  figures_.push_back(figure);
  return figures_.size() - 1;
}

std::vector<double> EnergyFormula::figures(Side side) const {
  std::vector<double> out;
  out.reserve(figures_.size());
  for (const Figure& figure : figures_) out.push_back(figure.at(side));
  return out;
}

EnergyFormula::Kinds EnergyFormula::of(const Unit& unit, const std::vector<double>& figures, Side side) const {
  const PowerScale& scale = scales_[unit.block];
  Kinds sum;
  double on_chip = 0;
  for (const Term& term : unit.terms) {
    const DeviceEvent* device = figures_[term.figure].device;
    (device == nullptr ? on_chip : device->standby ? sum.leakage : sum.dynamic) += figures[term.figure] * term.count;
  }
  const double share = config_.clock_share.*side;
  sum.dynamic += on_chip * scale.dynamic;
  sum.clock = (on_chip * (share / (1 - share)) +
               config_.flop_clock.*side * (config_.idle_clocked.*side) * (unit.flops->*side) * unit.idle_cycles) *
              scale.dynamic;
  sum.leakage += (config_.sram_leakage.*side * unit.sram_kib + config_.logic_leakage.*side * unit.logic.at(side)) *
                 leakage_pj_per_mw_ * scale.leakage;
  return sum;
}

std::vector<double> EnergyFormula::of_blocks(Side side) const {
  const std::vector<double> values = figures(side);
  std::vector<Kinds> kinds(blocks_.size());
  for (const Unit& unit : units_) kinds[unit.block].add(of(unit, values, side));
  std::vector<double> out;
  for (const Kinds& block : kinds) out.push_back(block.total());
  return out;
}

std::vector<double> EnergyFormula::of_kinds(Side side) const {
  const std::vector<double> values = figures(side);
  Kinds sum;
  for (const Unit& unit : units_) sum.add(of(unit, values, side));
  return {sum.dynamic, sum.clock, sum.leakage};
}

double EnergyFormula::total(Side side) const {
  const std::vector<double> values = figures(side);
  Kinds sum;
  for (const Unit& unit : units_) sum.add(of(unit, values, side));
  return sum.total();
}

std::vector<EnergyFormula::UnitEnergy> EnergyFormula::of_units() const {
  std::vector<UnitEnergy> all(units_.size());
  for (const Side side : kSides) {
    const std::vector<double> values = figures(side);
    const double share = config_.clock_share.*side;
    for (std::size_t u = 0; u < units_.size(); ++u) {
      const Unit& unit = units_[u];
      const PowerScale& scale = scales_[unit.block];
      all[u].events.resize(unit.terms.size());
      double counted = 0;
      for (std::size_t t = 0; t < unit.terms.size(); ++t) {
        const DeviceEvent* device = figures_[unit.terms[t].figure].device;
        double pj = values[unit.terms[t].figure] * unit.terms[t].count;
        if (device == nullptr) pj = pj / (1 - share) * scale.dynamic;
        if (device == nullptr || !device->standby) counted += all[u].events[t].*side = pj;
      }
      all[u].standing.*side = of(unit, values, side).total() - counted;
    }
  }
  return all;
}

EnergyReport EnergyFormula::report() const {
  EnergyReport report;
  for (const Side side : kSides) {
    const std::vector<double> values = figures(side);
    for (const Unit& unit : units_) {
      const Kinds kinds = of(unit, values, side);
      std::map<std::string, Spread>& events = report.events[blocks_[unit.block]];
      for (const Term& term : unit.terms) {
        const double scale = figures_[term.figure].device == nullptr ? scales_[unit.block].dynamic : 1;
        events[term.event].*side += values[term.figure] * term.count * scale;
      }
      for (EnergyByKind* sum : {&report.blocks[blocks_[unit.block]], &report.kinds}) {
        sum->dynamic.*side += kinds.dynamic;
        sum->clock.*side += kinds.clock;
        sum->leakage.*side += kinds.leakage;
      }
    }
  }
  report.total_pj = report.kinds.total();
  return report;
}

}  // namespace sim
