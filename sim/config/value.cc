#include "sim/config/value.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "sim/config/overloaded.h"
#include "sim/config/quantity.h"

namespace sim {
namespace {

std::string_view trim(std::string_view text) {
  while (text.starts_with(' ')) text.remove_prefix(1);
  while (text.ends_with(' ')) text.remove_suffix(1);
  return text;
}

/// Removes the field's unit after a number, if present.
std::string_view without_unit(std::string_view text, std::string_view unit) {
  const std::size_t gap = text.find(' ');
  if (gap != std::string_view::npos && !unit.empty() && trim(text.substr(gap)) == unit) return text.substr(0, gap);
  return text;
}

[[noreturn]] void not_a(std::string_view text, std::string_view what, const ConfigNode& field) {
  throw BadValue{fmt::format("'{}' is not {}; allowed: {}", text, what, allowed_text(field))};
}

std::string out_of_range(const ConfigNode& field, std::string_view text) {
  return fmt::format("'{}' is out of range; allowed: {}", text, allowed_text(field));
}

template <class Integer>
Integer integer_of(const ConfigNode& field, std::string_view text) {
  const std::string_view digits = without_unit(text, field.unit);
  Integer value = 0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  if (error == std::errc::result_out_of_range && end == digits.data() + digits.size()) {
    throw BadValue{out_of_range(field, text)};
  }
  if (error != std::errc{} || end != digits.data() + digits.size()) {
    const bool is_negative = digits.size() > 1 && digits.find_first_not_of("0123456789", 1) == std::string_view::npos &&
                             digits.front() == '-';
    if (is_negative) throw BadValue{out_of_range(field, text)};
    not_a(text, "a whole number", field);
  }
  return value;
}

std::uint64_t quantity_of(const ConfigNode& field, std::string_view text, std::span<const Unit> units) {
  try {
    return read_quantity(text, units);
  } catch (const BadValue& bad) {
    throw BadValue{fmt::format("{}; allowed: {}", bad.problem, allowed_text(field))};
  }
}

bool within(double value, const Limits& limits) {
  if (!(value >= limits.min && value <= limits.max)) return false;
  int exponent = 0;
  return !limits.power_of_two || (value >= 1 && std::frexp(value, &exponent) == 0.5);
}

std::string spread_problem(const ConfigNode& field, const Spread& spread) {
  const Limits limits = effective_limits(field);
  for (const double value : {spread.low, spread.nominal, spread.high}) {
    if (!within(value, limits)) return out_of_range(field, fmt::format("{}", value));
  }
  if (spread.low <= spread.nominal && spread.nominal <= spread.high) return {};
  return fmt::format("'{}' is not in order; allowed: low <= nominal <= high", spread_text(spread));
}

/// Parses a number; `text` is the user's text, for errors.
double double_of(const ConfigNode& field, std::string_view digits, std::string_view text, std::string_view what) {
  double value = 0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  if (error != std::errc{} || end != digits.data() + digits.size() || !std::isfinite(value)) not_a(text, what, field);
  return value + 0.0;  // turns -0 into 0
}

Triple triple_of(const ConfigNode& field, std::string_view text) {
  constexpr std::string_view kWhat = "three numbers";
  std::array<double, 3> values{};
  std::string_view rest = text;
  for (double& value : values) {
    rest = trim(rest);
    const std::string_view digits = rest.substr(0, rest.find(' '));
    value = double_of(field, digits, text, kWhat);
    rest.remove_prefix(digits.size());
  }
  if (!trim(rest).empty()) not_a(text, kWhat, field);
  return {values[0], values[1], values[2]};
}

std::string triple_problem(const ConfigNode& field, const Triple& triple) {
  for (const double value : {triple.x, triple.y, triple.z}) {
    if (!within(value, effective_limits(field))) return out_of_range(field, fmt::format("{}", value));
  }
  return {};
}

}  // namespace

double number_of(const ConfigNode& field, std::string_view raw) {
  const std::string_view text = trim(raw);
  const std::string_view digits = without_unit(text, field.unit);
  return double_of(field, digits, text, "a number");
}

void assign(const ConfigNode& field, std::string_view raw) {
  const std::string_view text = trim(raw);
  std::visit(Overloaded{
                 [&](bool* member) {
                   if (text != "true" && text != "false") not_a(text, "true or false", field);
                   *member = text == "true";
                 },
                 [&](std::uint32_t* member) { *member = integer_of<std::uint32_t>(field, text); },
                 [&](std::uint64_t* member) { *member = integer_of<std::uint64_t>(field, text); },
                 [&](double* member) { *member = number_of(field, text); },
                 [&](std::string* member) { *member = raw; },
                 [&](Frequency* member) { member->hz = quantity_of(field, text, frequency_units()); },
                 [&](ByteSize* member) { member->bytes = quantity_of(field, text, byte_units()); },
                 [&](Duration* member) { member->time = quantity_of(field, text, duration_units()); },
                 [&](AutoCount* member) {
                   member->is_auto = text == "auto";
                   if (!member->is_auto) member->value = integer_of<std::uint32_t>(field, text);
                 },
                 [&](Triple* member) { *member = triple_of(field, text); },
                 [&](Spread* member) {
                   const double value = number_of(field, text);
                   *member = {value, value, value};
                 },
                 [&](std::map<std::string, Spread>*) { not_a(text, "a mapping of names to figures", field); },
                 [&](const EnumTarget& member) {
                   auto name = std::ranges::find(member.names, text);
                   if (name == member.names.end() && (text == "true" || text == "false")) {
                     // PyYAML writes `off` back as `false`.
                     name = std::ranges::find_if(member.names, [&](std::string_view choice) {
                       return boolean_of_word(choice) == (text == "true");
                     });
                   }
                   if (name == member.names.end()) not_a(text, "one of the choices", field);
                   member.set(static_cast<std::size_t>(name - member.names.begin()));
                 },
             },
             *field.target);
}

std::string value_problem(const ConfigNode& field) {
  const auto number = [&](double value) {
    return within(value, effective_limits(field)) ? std::string{} : out_of_range(field, value_text(field));
  };
  return std::visit(Overloaded{
                        [&](const bool*) { return std::string{}; },
                        [&](const std::uint32_t* member) { return number(static_cast<double>(*member)); },
                        [&](const std::uint64_t* member) { return number(static_cast<double>(*member)); },
                        [&](const double* member) { return number(*member); },
                        [&](const std::string*) { return std::string{}; },
                        [&](const Frequency* member) { return number(static_cast<double>(member->hz)); },
                        [&](const ByteSize* member) { return number(static_cast<double>(member->bytes)); },
                        [&](const Duration* member) { return number(static_cast<double>(member->time)); },
                        [&](const AutoCount* member) { return number(member->value); },
                        [&](const Triple* member) { return triple_problem(field, *member); },
                        [&](const Spread* member) { return spread_problem(field, *member); },
                        [&](const std::map<std::string, Spread>* member) {
                          for (const auto& [name, spread] : *member) {
                            const std::string problem = spread_problem(field, spread);
                            if (!problem.empty()) return fmt::format("{}: {}", name, problem);
                          }
                          return std::string{};
                        },
                        [&](const EnumTarget& member) {
                          return member.get() < member.names.size() ? std::string{} : "is not one of its choices";
                        },
                    },
                    *field.target);
}

}  // namespace sim
