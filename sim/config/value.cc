#include "sim/config/value.h"

#include <algorithm>
#include <bit>
#include <charconv>
#include <cmath>
#include <limits>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "sim/config/quantity.h"

namespace sim {
namespace {

template <class... Cases>
struct Overloaded : Cases... {
  using Cases::operator()...;
};

std::string_view trim(std::string_view text) {
  while (text.starts_with(' ')) text.remove_prefix(1);
  while (text.ends_with(' ')) text.remove_suffix(1);
  return text;
}

/// The number in front of the field's unit, which may be left out.
std::string_view without_unit(std::string_view text, std::string_view unit) {
  const std::size_t gap = text.find(' ');
  if (gap != std::string_view::npos && !unit.empty() && trim(text.substr(gap)) == unit) return text.substr(0, gap);
  return text;
}

[[noreturn]] void not_a(std::string_view text, std::string_view what, const ConfigNode& field) {
  throw BadValue{fmt::format("'{}' is not {}; allowed: {}", text, what, allowed_text(field))};
}

template <class Integer>
Integer integer_of(const ConfigNode& field, std::string_view text) {
  const std::string_view digits = without_unit(text, field.unit);
  Integer value = 0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  if (error == std::errc::result_out_of_range && end == digits.data() + digits.size()) {
    throw BadValue{fmt::format("'{}' is out of range; allowed: {}", text, allowed_text(field))};
  }
  if (error != std::errc{} || end != digits.data() + digits.size()) not_a(text, "a whole number", field);
  return value;
}

std::uint64_t quantity_of(const ConfigNode& field, std::string_view text, std::span<const Unit> units) {
  try {
    return read_quantity(text, units);
  } catch (const BadValue& bad) {
    throw BadValue{fmt::format("{}; allowed: {}", bad.problem, allowed_text(field))};
  }
}

std::span<const Unit> units_of(const ConfigNode& field) {
  switch (field.kind()) {
    case FieldKind::kFrequency:
      return frequency_units();
    case FieldKind::kByteSize:
      return byte_units();
    case FieldKind::kDuration:
      return duration_units();
    default:
      return {};
  }
}

std::string bound_text(const ConfigNode& field, double bound) {
  const std::span<const Unit> units = units_of(field);
  if (!units.empty()) return quantity_text(static_cast<std::uint64_t>(bound), units);
  return fmt::format("{}", bound);
}

/// The bounds that hold: the declared ones, and those of the member's type.
Limits effective_limits(const ConfigNode& field) {
  Limits limits = field.limits;
  const FieldKind kind = field.kind();
  if (kind != FieldKind::kDouble && kind != FieldKind::kSpread && kind != FieldKind::kSpreadMap) {
    limits.min = std::max(limits.min, 0.0);
  }
  if (kind == FieldKind::kUint32) limits.max = std::min(limits.max, double{std::numeric_limits<std::uint32_t>::max()});
  return limits;
}

bool within(double value, const Limits& limits) {
  if (!(value >= limits.min && value <= limits.max)) return false;
  return !limits.power_of_two || (value >= 1 && std::has_single_bit(static_cast<std::uint64_t>(value)));
}

std::string out_of_range(const ConfigNode& field, std::string_view text) {
  return fmt::format("'{}' is out of range; allowed: {}", text, allowed_text(field));
}

std::string spread_problem(const ConfigNode& field, const Spread& spread) {
  const Limits limits = effective_limits(field);
  for (const double value : {spread.low, spread.nominal, spread.high}) {
    if (!within(value, limits)) return out_of_range(field, fmt::format("{}", value));
  }
  if (spread.low <= spread.nominal && spread.nominal <= spread.high) return {};
  return fmt::format("'{}' is not in order; allowed: low <= nominal <= high", spread_text(spread));
}

}  // namespace

double number_of(const ConfigNode& field, std::string_view raw) {
  const std::string_view text = trim(raw);
  const std::string_view digits = without_unit(text, field.unit);
  double value = 0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  if (error != std::errc{} || end != digits.data() + digits.size() || !std::isfinite(value)) {
    not_a(text, "a number", field);
  }
  return value + 0.0;  // so that -0 is 0
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
                 [&](Spread* member) {
                   const double value = number_of(field, text);
                   *member = {value, value, value};
                 },
                 [&](std::map<std::string, Spread>*) { not_a(text, "a mapping of names to figures", field); },
                 [&](const EnumTarget& member) {
                   const auto name = std::ranges::find(member.names, text);
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

std::string value_text(const ConfigNode& field) {
  return std::visit(Overloaded{
                        [](const bool* member) { return fmt::format("{}", *member); },
                        [](const std::uint32_t* member) { return fmt::format("{}", *member); },
                        [](const std::uint64_t* member) { return fmt::format("{}", *member); },
                        [](const double* member) { return fmt::format("{}", *member); },
                        [](const std::string* member) { return double_quoted(*member); },
                        [](const Frequency* member) { return quantity_text(member->hz, frequency_units()); },
                        [](const ByteSize* member) { return quantity_text(member->bytes, byte_units()); },
                        [](const Duration* member) { return quantity_text(member->time, duration_units()); },
                        [](const Spread* member) { return spread_text(*member); },
                        [](const std::map<std::string, Spread>* member) {
                          std::vector<std::string> entries;
                          for (const auto& [name, spread] : *member) {
                            entries.push_back(fmt::format("{}: {}", key_text(name), spread_text(spread)));
                          }
                          return fmt::format("{{{}}}", fmt::join(entries, ", "));
                        },
                        [](const EnumTarget& member) { return std::string(member.names.at(member.get())); },
                    },
                    *field.target);
}

std::string spread_text(const Spread& spread) {
  if (spread.low == spread.nominal && spread.nominal == spread.high) return fmt::format("{}", spread.nominal);
  return fmt::format("{{low: {}, nominal: {}, high: {}}}", spread.low, spread.nominal, spread.high);
}

std::string double_quoted(std::string_view text) {
  using Json = nlohmann::json;
  return Json(text).dump(-1, ' ', false, Json::error_handler_t::replace);
}

std::string key_text(std::string_view key) {
  constexpr std::string_view kPlain = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_.@";
  const bool plain = !key.empty() && key.find_first_not_of(kPlain) == std::string_view::npos && key.front() != '@';
  const bool is_null = key == "null" || key == "Null" || key == "NULL";
  return plain && !is_null ? std::string(key) : double_quoted(key);
}

std::string allowed_text(const ConfigNode& field) {
  switch (field.kind()) {
    case FieldKind::kBool:
      return "true, false";
    case FieldKind::kString:
      return "any text";
    case FieldKind::kEnum:
      return fmt::format("{}", fmt::join(std::get<EnumTarget>(*field.target).names, ", "));
    default:
      break;
  }
  const Limits limits = effective_limits(field);
  const bool floor = std::isfinite(limits.min);
  const bool ceiling = std::isfinite(limits.max);
  std::string text = limits.power_of_two ? "powers of two" : "any number";
  if (floor && ceiling) {
    text = limits.power_of_two ? "powers of two from " : "";
    text += fmt::format("{} to {}", bound_text(field, limits.min), bound_text(field, limits.max));
  } else if (floor) {
    text = fmt::format("{}at least {}", limits.power_of_two ? "powers of two, " : "", bound_text(field, limits.min));
  } else if (ceiling) {
    text = fmt::format("{}at most {}", limits.power_of_two ? "powers of two, " : "", bound_text(field, limits.max));
  }
  return units_of(field).empty() && !field.unit.empty() ? fmt::format("{} {}", text, field.unit) : text;
}

}  // namespace sim
