#include "tools/sweep/results/value.h"

#include <charconv>
#include <cmath>
#include <span>
#include <tuple>
#include <utility>

#include <fmt/format.h>

#include "sim/config/quantity.h"
#include "sim/config/value.h"

namespace tools::results {

std::string exact_text(const Value& value) {
  if (const auto* text = std::get_if<std::string>(&value)) return *text;
  if (const auto* whole = std::get_if<std::int64_t>(&value)) return fmt::format("{}", *whole);
  if (const auto* real = std::get_if<double>(&value)) return fmt::format("{}", *real);
  return {};
}

std::optional<Magnitude> magnitude_of(std::string_view text) {
  double number = 0;
  const auto [end, failed] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (failed != std::errc()) return std::nullopt;
  if (end == text.data() + text.size()) {
    return std::isfinite(number) ? std::optional(Magnitude{Magnitude::Kind::kNumber, number}) : std::nullopt;
  }
  const std::pair<Magnitude::Kind, std::span<const sim::Unit>> kinds[] = {
      {Magnitude::Kind::kBytes, sim::byte_units()},
      {Magnitude::Kind::kFrequency, sim::frequency_units()},
      {Magnitude::Kind::kTime, sim::duration_units()}};
  for (const auto& [kind, units] : kinds) {
    try {
      return Magnitude{kind, static_cast<double>(sim::read_quantity(text, units))};
    } catch (const sim::BadValue&) {  // of another kind, or text
    }
  }
  return std::nullopt;
}

std::optional<Magnitude> amount_of(const Value& value) {
  if (const auto* text = std::get_if<std::string>(&value)) return magnitude_of(*text);
  if (const auto* whole = std::get_if<std::int64_t>(&value)) {
    return Magnitude{Magnitude::Kind::kNumber, static_cast<double>(*whole)};
  }
  if (const auto* real = std::get_if<double>(&value)) return Magnitude{Magnitude::Kind::kNumber, *real};
  return std::nullopt;
}

bool is_before(const Value& a, const Value& b) {
  const auto key = [](const Value& value) {
    const std::optional<Magnitude> number = amount_of(value);
    const int group = number ? 0 : is_absent(value) ? 2 : 1;
    return std::tuple(group, number ? number->value : 0, number ? std::string() : exact_text(value));
  };
  return key(a) < key(b);
}

}  // namespace tools::results
