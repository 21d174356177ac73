#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "sim/config/overloaded.h"
#include "sim/config/quantity.h"
#include "sim/config/value.h"
#include "sim/io/json.h"
#include "sim/io/printable.h"

namespace sim {
namespace {

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

}  // namespace

Limits effective_limits(const ConfigNode& field) {
  Limits limits = field.limits;
  const FieldKind kind = field.kind();
  if (kind != FieldKind::kDouble && kind != FieldKind::kSpread && kind != FieldKind::kSpreadMap &&
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

std::optional<bool> boolean_of_word(std::string_view word) {
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
