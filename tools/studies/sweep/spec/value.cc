#include "tools/studies/sweep/spec/value.h"

#include <charconv>
#include <cmath>
#include <tuple>

#include <fmt/format.h>

#include "sim/config/quantity.h"
#include "sim/config/value.h"

namespace tools::sweep {

std::optional<Magnitude> magnitude_of(std::string_view text) {
  double number = 0;
  const auto [end, bad] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (bad == std::errc{} && end == text.data() + text.size()) return Magnitude{Magnitude::Kind::kNumber, number};
  if (text.find_first_of("0123456789.") != 0) return std::nullopt;
  for (const auto& [kind, units] : {std::pair{Magnitude::Kind::kFrequency, sim::frequency_units()},
                                    {Magnitude::Kind::kBytes, sim::byte_units()},
                                    {Magnitude::Kind::kTime, sim::duration_units()}}) {
    try {
      return Magnitude{kind, static_cast<double>(sim::read_quantity(text, units))};
    } catch (const sim::BadValue&) {
    }
  }
  return std::nullopt;
}

std::string exact_text(const Value& value) {
  if (const auto* text = std::get_if<std::string>(&value)) return *text;
  if (const auto* whole = std::get_if<std::int64_t>(&value)) return fmt::format("{}", *whole);
  if (const auto* real = std::get_if<double>(&value)) return fmt::format("{}", *real);
  return {};
}

std::optional<Magnitude> amount_of(const Value& value) {
  if (const auto* text = std::get_if<std::string>(&value)) {
    const std::optional<Magnitude> amount = magnitude_of(*text);
    return amount && std::isfinite(amount->value) ? amount : std::nullopt;
  }
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

}  // namespace tools::sweep
