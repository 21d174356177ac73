#include "sim/report/energy_table.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include <fmt/format.h>

#include "sim/config/quantity.h"
#include "sim/config/value.h"
#include "sim/error.h"

namespace sim {
namespace {

double size_of(std::string_view key, const std::string& name, std::string_view size) {
  try {
    const std::uint64_t bytes = read_quantity(size, byte_units());
    if (bytes > 0) return static_cast<double>(bytes);
    throw BadValue{"a size of 0"};
  } catch (const BadValue& bad) {
    throw InputError(fmt::format("{}.{}: {}; allowed: a size such as @16KiB", key, name, bad.problem));
  }
}

}  // namespace

EnergyTable::EnergyTable(const std::map<std::string, Band>& events, std::string_view key) {
  for (const auto& [name, pj] : events) {
    const std::size_t at = name.find('@');
    const double bytes = at == std::string::npos ? 0 : size_of(key, name, std::string_view(name).substr(at + 1));
    std::vector<EnergyCurve::Point>& curve = curves_[event_name_of(name)].points_;
    if (!curve.empty() && (bytes == 0 || curve.front().bytes == 0)) {
      throw InputError(fmt::format("{}.{}: given with and without a size; allowed: either", key, name));
    }
    curve.push_back({bytes, &pj});
  }
  for (auto& [name, curve] : curves_) std::ranges::sort(curve.points_, {}, &EnergyCurve::Point::bytes);
}

double EnergyPoint::energy_of(BandMember member) const {
  const double pj = left->*member;
  return right == nullptr ? pj : pj * std::pow(right->*member / pj, part);
}

EnergyPoint EnergyCurve::point_at(std::uint64_t bytes) const {
  if (points_.size() == 1) return {.left = points_.front().pj};
  assert(bytes > 0);
  const auto size = static_cast<double>(bytes);
  const auto above = std::ranges::find_if(points_, [&](const Point& p) { return p.bytes >= size; });
  const auto right = std::clamp(above, points_.begin() + 1, points_.end() - 1);
  const Point& a = *(right - 1);
  const Point& b = *right;
  return {a.pj, b.pj, std::log(size / a.bytes) / std::log(b.bytes / a.bytes)};
}

Band EnergyTable::energy_of(std::string_view event, std::uint64_t bytes) const {
  const EnergyPoint point = curve_of(event).point_at(bytes);
  return {point.energy_of(&Band::low), point.energy_of(&Band::nominal), point.energy_of(&Band::high)};
}

std::vector<std::string> EnergyTable::event_names() const {
  std::vector<std::string> names;
  for (const auto& [name, curve] : curves_) names.push_back(name);
  return names;
}

const Band& required_entry(const std::map<std::string, Band>& table, const UnitReport& unit, std::string_view key) {
  if (const Band* const entry = find_entry(table, unit)) return *entry;
  throw_missing_entry(unit, key);
}

void throw_missing_entry(const UnitReport& unit, std::string_view key) {
  throw InputError(
      fmt::format("{}: no entry for unit '{}'; allowed: '{}' or '{}'", key, unit.path, entry_name(unit), unit.block));
}

}  // namespace sim
