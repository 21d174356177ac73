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

double size_of(const std::string& name, std::string_view size) {
  try {
    const std::uint64_t bytes = read_quantity(size, byte_units());
    if (bytes > 0) return static_cast<double>(bytes);
    throw BadValue{"a size of 0"};
  } catch (const BadValue& bad) {
    throw InputError(fmt::format("energy.events.{}: {}; allowed: a size such as @16KiB", name, bad.problem));
  }
}

}  // namespace

EnergyTable::EnergyTable(const std::map<std::string, Spread>& events) {
  for (const auto& [name, pj] : events) {
    const std::size_t at = name.find('@');
    const double bytes = at == std::string::npos ? 0 : size_of(name, std::string_view(name).substr(at + 1));
    std::vector<Point>& curve = curves_[name.substr(0, at)];
    if (!curve.empty() && (bytes == 0 || curve.front().bytes == 0)) {
      throw InputError(fmt::format("energy.events.{}: given with and without a size; allowed: either", name));
    }
    curve.push_back({bytes, pj});
  }
  for (auto& [name, curve] : curves_) std::ranges::sort(curve, {}, &Point::bytes);
}

Spread EnergyTable::at(std::string_view event, std::uint64_t bytes) const {
  const std::vector<Point>& curve = curves_.at(std::string(event));
  if (curve.size() == 1) return curve.front().pj;
  assert(bytes > 0);
  const auto size = static_cast<double>(bytes);
  const auto above = std::ranges::find_if(curve, [&](const Point& p) { return p.bytes >= size; });
  const auto right = std::clamp(above, curve.begin() + 1, curve.end() - 1);
  const Point& a = *(right - 1);
  const Point& b = *right;
  const double part = std::log(size / a.bytes) / std::log(b.bytes / a.bytes);
  const auto power_law = [part](double left_pj, double right_pj) {
    return left_pj * std::pow(right_pj / left_pj, part);
  };
  return {power_law(a.pj.low, b.pj.low), power_law(a.pj.nominal, b.pj.nominal), power_law(a.pj.high, b.pj.high)};
}

std::vector<std::string> EnergyTable::names() const {
  std::vector<std::string> names;
  for (const auto& [name, curve] : curves_) names.push_back(name);
  return names;
}

}  // namespace sim
