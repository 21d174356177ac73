#include "tools/studies/optimise/goal.h"

#include <charconv>
#include <cmath>

#include <fmt/format.h>

#include "sim/error.h"
#include "sim/io/printable.h"
#include "tools/analysis/report_paths.h"

namespace tools::optimise {
namespace {

std::string trimmed(const std::string& text) {
  const std::size_t begin = text.find_first_not_of(' ');
  return begin == std::string::npos ? "" : text.substr(begin, text.find_last_not_of(' ') - begin + 1);
}

}  // namespace

bool Goal::is_met(double value) const {
  switch (kind) {
    case Kind::kBelow:
      return value < limit;
    case Kind::kAtMost:
      return value <= limit;
    case Kind::kAbove:
      return value > limit;
    case Kind::kAtLeast:
      return value >= limit;
    default:
      return true;
  }
}

std::string Goal::text() const {
  const std::string_view name = names_of(kind).at(static_cast<std::size_t>(kind));
  return is_objective() ? fmt::format("{} {}", name, metric_name(figure))
                        : fmt::format("{} {} {}", metric_name(figure), name, limit);
}

std::string Goal::room_title() const {
  return fmt::format("room to {} {}", names_of(kind).at(static_cast<std::size_t>(kind)), limit);
}

double Goal::room(double value) const {
  const double distance = is_upper() ? limit - value : value - limit;
  return limit == 0 ? distance : distance / std::abs(limit);
}

std::string Goal::room_text(double value) const {
  if (limit == 0) return fmt::format("{:.3g}", room(value));
  const double percent = 100 * room(value);
  return std::abs(percent) < 1 ? fmt::format("{:.2g} %", percent) : fmt::format("{:.1f} %", percent);
}

Goal read_constraint(const std::string& text) {
  const std::size_t sign = text.find_first_of("<>");
  if (sign != std::string::npos) {
    const bool or_equal = text.substr(sign + 1).starts_with('=');
    Goal goal;
    goal.kind = text[sign] == '<' ? (or_equal ? Goal::Kind::kAtMost : Goal::Kind::kBelow)
                                  : (or_equal ? Goal::Kind::kAtLeast : Goal::Kind::kAbove);
    goal.figure = trimmed(text.substr(0, sign));
    const std::string number = trimmed(text.substr(sign + (or_equal ? 2 : 1)));
    const auto [end, error] = std::from_chars(number.data(), number.data() + number.size(), goal.limit);
    const bool is_number = error == std::errc() && std::isfinite(goal.limit) && !goal.figure.empty();
    const std::string_view unit(end, number.data() + number.size());
    if (is_number && unit.empty()) return goal;
    if (is_number) {
      throw sim::InputError(
          fmt::format("constraint '{}': '{}' is no part of a number; figures have the unit of their name; "
                      "allowed: '{}'",
                      sim::printable(text), sim::printable(trimmed(std::string(unit))),
                      sim::printable(text.substr(0, text.size() - unit.size()))));
    }
  }
  throw sim::InputError(
      fmt::format("'{}' is no constraint; allowed: PATH < NUMBER, or with <=, >, >=, e.g. "
                  "power_w.nominal < 1",
                  sim::printable(text)));
}

}  // namespace tools::optimise
