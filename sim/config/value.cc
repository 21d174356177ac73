#include "sim/config/value.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <limits>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "sim/config/quantity.h"
#include "sim/io/json.h"
#include "sim/io/printable.h"

namespace sim {
namespace {

std::string_view trim_blanks(std::string_view text) {
  while (text.starts_with(' ')) text.remove_prefix(1);
  while (text.ends_with(' ')) text.remove_suffix(1);
  return text;
}

/// Returns a text without the field's unit, if the text ends with it.
std::string_view without_unit(std::string_view text, std::string_view unit) {
  const std::size_t gap = text.find(' ');
  if (gap != std::string_view::npos && !unit.empty() && trim_blanks(text.substr(gap)) == unit)
    return text.substr(0, gap);
  return text;
}

[[noreturn]] void throw_wrong_kind(std::string_view text, std::string_view what, const ConfigNode& field) {
  throw BadValue{fmt::format("'{}' is not {}; allowed: {}", text, what, allowed_text(field))};
}

std::string out_of_range_text(const ConfigNode& field, std::string_view text) {
  return fmt::format("'{}' is out of range; allowed: {}", text, allowed_text(field));
}

template <class Integer>
Integer parse_integer(const ConfigNode& field, std::string_view text) {
  const std::string_view digits = without_unit(text, field.unit);
  Integer value = 0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  if (error == std::errc::result_out_of_range && end == digits.data() + digits.size()) {
    throw BadValue{out_of_range_text(field, text)};
  }
  if (error != std::errc{} || end != digits.data() + digits.size()) {
    const bool is_negative = digits.size() > 1 && digits.find_first_not_of("0123456789", 1) == std::string_view::npos &&
                             digits.front() == '-';
    if (is_negative) throw BadValue{out_of_range_text(field, text)};
    throw_wrong_kind(text, "a whole number", field);
  }
  return value;
}

std::uint64_t parse_quantity(const ConfigNode& field, std::string_view text, std::span<const MeasureUnit> units) {
  try {
    return read_quantity(text, units);
  } catch (const BadValue& bad) {
    throw BadValue{fmt::format("{}; allowed: {}", bad.problem, allowed_text(field))};
  }
}

bool is_within(double value, const Limits& limits) {
  if (!(value >= limits.min && value <= limits.max)) return false;
  int exponent = 0;
  return !limits.power_of_two || (value >= 1 && std::frexp(value, &exponent) == 0.5);
}

std::string band_problem(const ConfigNode& field, const Band& band) {
  const Limits limits = effective_limits(field);
  for (const double value : {band.low, band.nominal, band.high}) {
    if (!is_within(value, limits)) return out_of_range_text(field, fmt::format("{}", value));
  }
  if (band.low <= band.nominal && band.nominal <= band.high) return {};
  return fmt::format("'{}' is not in order; allowed: low <= nominal <= high", band_text(band));
}

/// Parses the number `digits` as the value of a configuration field. `text`: the whole text of the value, for errors.
double parse_double(const ConfigNode& field, std::string_view digits, std::string_view text, std::string_view what) {
  double value = 0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  if (error != std::errc{} || end != digits.data() + digits.size() || !std::isfinite(value))
    throw_wrong_kind(text, what, field);
  return value + 0.0;  // turns -0 into 0
}

Triple parse_triple(const ConfigNode& field, std::string_view text) {
  constexpr std::string_view kWhat = "three numbers";
  std::array<double, 3> values{};
  std::string_view rest = text;
  for (double& value : values) {
    rest = trim_blanks(rest);
    const std::string_view digits = rest.substr(0, rest.find(' '));
    value = parse_double(field, digits, text, kWhat);
    rest.remove_prefix(digits.size());
  }
  if (!trim_blanks(rest).empty()) throw_wrong_kind(text, kWhat, field);
  return {values[0], values[1], values[2]};
}

std::string triple_problem(const ConfigNode& field, const Triple& triple) {
  for (const double value : {triple.x, triple.y, triple.z}) {
    if (!is_within(value, effective_limits(field))) return out_of_range_text(field, fmt::format("{}", value));
  }
  return {};
}

}  // namespace

double parse_number(const ConfigNode& field, std::string_view raw) {
  const std::string_view text = trim_blanks(raw);
  const std::string_view digits = without_unit(text, field.unit);
  return parse_double(field, digits, text, "a number");
}

void parse_value(const ConfigNode& field, std::string_view raw) {
  const std::string_view text = trim_blanks(raw);
  std::visit(Overloaded{
                 [&](bool* member) {
                   if (text != "true" && text != "false") throw_wrong_kind(text, "true or false", field);
                   *member = text == "true";
                 },
                 [&](std::uint32_t* member) { *member = parse_integer<std::uint32_t>(field, text); },
                 [&](std::uint64_t* member) { *member = parse_integer<std::uint64_t>(field, text); },
                 [&](double* member) { *member = parse_number(field, text); },
                 [&](std::string* member) { *member = raw; },
                 [&](Frequency* member) { member->hz = parse_quantity(field, text, frequency_units()); },
                 [&](ByteSize* member) { member->bytes = parse_quantity(field, text, byte_units()); },
                 [&](Duration* member) { member->time = parse_quantity(field, text, duration_units()); },
                 [&](AutoCount* member) {
                   member->is_auto = text == "auto";
                   if (!member->is_auto) member->value = parse_integer<std::uint32_t>(field, text);
                 },
                 [&](Triple* member) { *member = parse_triple(field, text); },
                 [&](Band* member) {
                   const double value = parse_number(field, text);
                   *member = {value, value, value};
                 },
                 [&](std::map<std::string, Band>*) { throw_wrong_kind(text, "a mapping of names to figures", field); },
                 [&](const EnumTarget& member) {
                   auto name = std::ranges::find(member.names, text);
                   if (name == member.names.end() && (text == "true" || text == "false")) {
                     // A YAML 1.1 writer such as PyYAML turns `off` into `false`, which is also accepted.
                     name = std::ranges::find_if(member.names, [&](std::string_view choice) {
                       return yaml_boolean_of(choice) == (text == "true");
                     });
                   }
                   if (name == member.names.end()) throw_wrong_kind(text, "one of the choices", field);
                   member.set(static_cast<std::size_t>(name - member.names.begin()));
                 },
             },
             *field.target);
}

std::string value_problem(const ConfigNode& field) {
  const auto number = [&](double value) {
    return is_within(value, effective_limits(field)) ? std::string{} : out_of_range_text(field, value_text(field));
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
                        [&](const Band* member) { return band_problem(field, *member); },
                        [&](const std::map<std::string, Band>* member) {
                          for (const auto& [name, band] : *member) {
                            const std::string problem = band_problem(field, band);
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

namespace {

std::span<const MeasureUnit> units_of(const ConfigNode& field) {
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
  const std::span<const MeasureUnit> units = units_of(field);
  if (!units.empty()) return quantity_text(static_cast<std::uint64_t>(bound), units);
  return fmt::format("{}", bound);
}

}  // namespace

Limits effective_limits(const ConfigNode& field) {
  Limits limits = field.limits;
  const FieldKind kind = field.kind();
  if (kind != FieldKind::kDouble && kind != FieldKind::kBand && kind != FieldKind::kBandMap &&
      kind != FieldKind::kTriple) {
    limits.min = std::max(limits.min, 0.0);
  }
  if (kind == FieldKind::kUint32 || kind == FieldKind::kAutoCount)
    limits.max = std::min(limits.max, double{std::numeric_limits<std::uint32_t>::max()});
  return limits;
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
                        [](const AutoCount* member) {
                          return member->is_auto ? std::string("auto") : fmt::format("{}", member->value);
                        },
                        [](const Triple* member) { return fmt::format("{} {} {}", member->x, member->y, member->z); },
                        [](const Band* member) { return band_text(*member); },
                        [](const std::map<std::string, Band>* member) {
                          std::vector<std::string> entries;
                          for (const auto& [name, band] : *member) {
                            entries.push_back(fmt::format("{}: {}", key_text(name), band_text(band)));
                          }
                          return fmt::format("{{{}}}", fmt::join(entries, ", "));
                        },
                        [](const EnumTarget& member) { return std::string(member.names.at(member.get())); },
                    },
                    *field.target);
}

std::string band_text(const Band& band) {
  if (band.low == band.nominal && band.nominal == band.high) return fmt::format("{}", band.nominal);
  return fmt::format("{{low: {}, nominal: {}, high: {}}}", band.low, band.nominal, band.high);
}

std::optional<bool> yaml_boolean_of(std::string_view word) {
  if (word == "on" || word == "yes" || word == "y") return true;
  if (word == "off" || word == "no" || word == "n") return false;
  return {};
}

std::string double_quoted(std::string_view text) { return json_line(Json(with_escaped_bytes(text))); }

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
  const std::string_view three = field.kind() == FieldKind::kTriple ? "three numbers, each " : "";
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
  text.insert(0, three);
  if (units_of(field).empty() && !field.unit.empty()) text += " " + field.unit;
  return field.kind() == FieldKind::kAutoCount ? text + ", or auto" : text;
}

}  // namespace sim
