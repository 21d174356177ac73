#include "tools/analysis/units.h"

namespace tools {

namespace {

template <class F>
double sum(const std::vector<const sim::UnitReport*>& units, F&& f) {
  std::uint64_t total = 0;
  for (const sim::UnitReport* unit : units) total += f(*unit);
  return static_cast<double>(total);
}

std::uint64_t counter_of(const sim::UnitReport& unit, std::string_view name) {
  const auto found = std::ranges::find(unit.counters, name, &sim::CounterReport::name);
  return found == unit.counters.end() ? 0 : found->value;
}

}  // namespace

std::uint64_t sum_of(std::span<const sim::UnitReport> units, std::string_view block, std::string_view counter) {
  std::uint64_t total = 0;
  for (const sim::UnitReport& unit : units) total += unit.block == block ? counter_of(unit, counter) : 0;
  return total;
}

Units::Units(std::span<const sim::UnitReport> units, std::string_view prefix, std::string_view kind) {
  for (const sim::UnitReport& unit : units) {
    if (unit.path.starts_with(prefix) && unit.path.find(kind) != std::string::npos) units_.push_back(&unit);
  }
}

double Units::elapsed() const {
  return sum(units_, [](const sim::UnitReport& unit) { return unit.elapsed; });
}

double Units::spent(std::string_view reason) const {
  return sum(units_, [&](const sim::UnitReport& unit) {
    const auto found = std::ranges::find(unit.why, reason, [](const auto& why) { return std::string_view(why.first); });
    return found == unit.why.end() ? 0 : found->second;
  });
}

double Units::counted(std::string_view counter) const {
  return sum(units_, [&](const sim::UnitReport& unit) { return counter_of(unit, counter); });
}

}  // namespace tools
