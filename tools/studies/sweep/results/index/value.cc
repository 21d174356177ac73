#include "tools/studies/sweep/results/index/value.h"

#include <cmath>
#include <tuple>

#include <fmt/format.h>

namespace tools::results {

std::string exact_text(const Value& value) {
  if (const auto* text = std::get_if<std::string>(&value)) return *text;
  if (const auto* whole = std::get_if<std::int64_t>(&value)) return fmt::format("{}", *whole);
  if (const auto* real = std::get_if<double>(&value)) return fmt::format("{}", *real);
  return {};
}

std::optional<sweep::Magnitude> amount_of(const Value& value) {
  if (const auto* text = std::get_if<std::string>(&value)) {
    const std::optional<sweep::Magnitude> amount = sweep::magnitude_of(*text);
    return amount && std::isfinite(amount->value) ? amount : std::nullopt;
  }
  if (const auto* whole = std::get_if<std::int64_t>(&value)) {
    return sweep::Magnitude{sweep::Magnitude::Kind::kNumber, static_cast<double>(*whole)};
  }
  if (const auto* real = std::get_if<double>(&value)) return sweep::Magnitude{sweep::Magnitude::Kind::kNumber, *real};
  return std::nullopt;
}

bool is_before(const Value& a, const Value& b) {
  const auto key = [](const Value& value) {
    const std::optional<sweep::Magnitude> number = amount_of(value);
    const int group = number ? 0 : is_absent(value) ? 2 : 1;
    return std::tuple(group, number ? number->value : 0, number ? std::string() : exact_text(value));
  };
  return key(a) < key(b);
}

}  // namespace tools::results
