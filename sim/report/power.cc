#include "sim/report/power.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "sim/config/quantity.h"
#include "sim/config/value.h"
#include "sim/error.h"

namespace sim {
namespace {

std::uint64_t frequency_of(const std::string& name, std::string_view text) {
  try {
    const std::uint64_t hz = read_quantity(text, frequency_units());
    if (hz > 0) return hz;
    throw BadValue{"a frequency of 0"};
  } catch (const BadValue& bad) {
    throw InputError(
        fmt::format("power.dvfs.{}: {}; allowed: a domain and its frequency, such as tni@500MHz", name, bad.problem));
  }
}

}  // namespace

double VoltageCurve::voltage_at(std::uint64_t hz) const {
  const auto above = std::ranges::find_if(points_, [&](const Point& p) { return p.hz >= hz; });
  if (above != points_.end() && (above == points_.begin() || above->hz == hz)) return above->volt;
  if (points_.size() == 1) return points_.front().volt;
  const Point& b = above == points_.end() ? points_.back() : *above;
  const Point& a = *(&b - 1);
  return a.volt + (b.volt - a.volt) * (static_cast<double>(hz) - static_cast<double>(a.hz)) /
                      (static_cast<double>(b.hz) - static_cast<double>(a.hz));
}

std::map<std::string, VoltageCurve> voltage_curves(const PowerConfig& config) {
  std::map<std::string, VoltageCurve> curves;
  for (const auto& [name, volt] : config.dvfs) {
    const std::size_t at = std::min(name.find('@'), name.size());
    const std::uint64_t hz = frequency_of(name, std::string_view(name).substr(std::min(at + 1, name.size())));
    curves[name.substr(0, at)].points_.push_back({hz, volt.nominal});
  }
  for (auto& [domain, curve] : curves) {
    std::ranges::sort(curve.points_, {}, &VoltageCurve::Point::hz);
    for (std::size_t i = 1; i < curve.points_.size(); ++i) {
      const VoltageCurve::Point &a = curve.points_[i - 1], &b = curve.points_[i];
      if (a.hz < b.hz && a.volt <= b.volt) continue;
      throw InputError(fmt::format(
          "power.dvfs: {} has {} V at {} and {} V at {}; allowed: one voltage a frequency, "
          "which does not fall as the clock rises",
          domain, a.volt, quantity_text(a.hz, frequency_units()), b.volt, quantity_text(b.hz, frequency_units())));
    }
  }
  return curves;
}

PowerScale power_scale(const PowerConfig& config, double volt) {
  const double ratio = volt / config.nominal_voltage;
  return {ratio * ratio, std::pow(ratio, config.leakage_exponent) *
                             std::exp2((config.temperature - config.nominal_temperature) / config.leakage_doubling)};
}

}  // namespace sim
