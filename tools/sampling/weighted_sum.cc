#include "tools/sampling/weighted_sum.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace tools {
namespace {

/// Returns the weighted sum of a quantity over parts, at least 0. `of`: value of the quantity in a part.
double weighted_total(std::span<const Activity> parts, std::span<const double> weights, auto&& of) {
  double total = 0;
  for (std::size_t k = 0; k < parts.size(); ++k) total += weights[k] * static_cast<double>(of(parts[k]));
  return std::max(0.0, total);
}

std::uint64_t to_count(double x) { return static_cast<std::uint64_t>(std::llround(x)); }

}  // namespace

void set_weighted_units(std::vector<sim::UnitReport>& whole, std::span<const Activity> parts,
                        std::span<const double> weights) {
  for (std::size_t u = 0; u < whole.size(); ++u) {
    sim::UnitReport& unit = whole[u];
    for (std::size_t i = 0; i < unit.counters.size(); ++i) {
      sim::CounterReport& counter = unit.counters[i];
      if (counter.kind == sim::CounterKind::kPeak) continue;
      counter.value =
          to_count(weighted_total(parts, weights, [&](const Activity& p) { return p.units[u].counters[i].value; }));
    }
    std::vector<double> spent;
    for (std::size_t i = 0; i < unit.cycles_by_reason.size(); ++i) {
      spent.push_back(
          weighted_total(parts, weights, [&](const Activity& p) { return p.units[u].cycles_by_reason[i].second; }));
    }
    const double all = std::accumulate(spent.begin(), spent.end(), 0.0);
    const auto elapsed = static_cast<double>(unit.elapsed);
    std::uint64_t given = 0;
    for (std::size_t i = 0; i < unit.cycles_by_reason.size(); ++i) {
      const double cycles = all == elapsed ? spent[i] : all == 0 ? 0 : spent[i] / all * elapsed;
      unit.cycles_by_reason[i].second = static_cast<std::uint64_t>(cycles);
      given += unit.cycles_by_reason[i].second;
    }
    if (unit.cycles_by_reason.empty()) continue;
    // The largest reason absorbs the rounding difference.
    std::ranges::max_element(unit.cycles_by_reason, {}, [](const auto& why) { return why.second; })->second +=
        unit.elapsed - given;
  }
}

std::vector<hw::KernelUse> weighted_kernels(std::span<const Activity> parts, std::span<const double> weights) {
  std::vector<hw::KernelUse> sums(parts.front().kernels.size());
  for (std::size_t k = 0; k < sums.size(); ++k) {
    for (const auto& [name, count] : hw::KernelUse::kCounts) {
      const auto member = count;
      sums[k].*count =
          to_count(weighted_total(parts, weights, [&](const Activity& p) { return p.kernels[k].*member; }));
    }
  }
  return sums;
}

}  // namespace tools
