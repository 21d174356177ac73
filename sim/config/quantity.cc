#include "sim/config/quantity.h"

#include <algorithm>
#include <array>
#include <limits>
#include <optional>

#include <fmt/format.h>

#include "sim/config/value.h"

namespace sim {
namespace {

constexpr std::array<MeasureUnit, 4> kFrequencyUnits{
    {{"Hz", 1}, {"kHz", 1'000}, {"MHz", 1'000'000}, {"GHz", 1'000'000'000}}};
constexpr std::array<MeasureUnit, 4> kByteUnits{{{"B", 1}, {"KiB", 1 << 10}, {"MiB", 1 << 20}, {"GiB", 1 << 30}}};
constexpr std::array<MeasureUnit, 6> kDurationUnits{{{"fs", 1},
                                                     {"ps", 1'000},
                                                     {"ns", 1'000'000},
                                                     {"us", 1'000'000'000},
                                                     {"ms", 1'000'000'000'000},
                                                     {"s", 1'000'000'000'000'000}}};

constexpr bool is_digit(char c) { return c >= '0' && c <= '9'; }

/// A decimal number: digits / 10^fraction_digits.
struct Decimal {
  std::uint64_t digits = 0;
  unsigned fraction_digits = 0;
};

/// Parses a decimal number without exponent. Returns nullopt if the text is not such a number, or its digits exceed 64
/// bits.
std::optional<Decimal> read_decimal(std::string_view text) {
  const std::size_t dot = text.find('.');
  const std::string_view whole = text.substr(0, dot);
  const std::string_view fraction = dot == std::string_view::npos ? std::string_view{} : text.substr(dot + 1);
  if (whole.empty() || (dot != std::string_view::npos && fraction.empty())) return std::nullopt;
  Decimal number{0, static_cast<unsigned>(fraction.size())};
  for (const std::string_view part : {whole, fraction}) {
    for (const char c : part) {
      const auto digit = static_cast<std::uint64_t>(c - '0');
      if (!is_digit(c) || number.digits > (std::numeric_limits<std::uint64_t>::max() - digit) / 10) return std::nullopt;
      number.digits = number.digits * 10 + digit;
    }
  }
  return number;
}

/// Divides the product a x b by a prime, by dividing `a` or `b`. Returns false if the prime divides neither.
bool divide_out(std::uint64_t& a, std::uint64_t& b, std::uint64_t prime) {
  std::uint64_t& factor = a % prime == 0 ? a : b;
  if (factor % prime != 0) return false;
  factor /= prime;
  return true;
}

}  // namespace

std::span<const MeasureUnit> frequency_units() { return kFrequencyUnits; }
std::span<const MeasureUnit> byte_units() { return kByteUnits; }
std::span<const MeasureUnit> duration_units() { return kDurationUnits; }

std::string names_of_units(std::span<const MeasureUnit> units, std::string_view separator) {
  std::string names;
  for (const MeasureUnit& unit : units) names.append(names.empty() ? "" : separator).append(unit.name);
  return names;
}

std::uint64_t read_quantity(std::string_view text, std::span<const MeasureUnit> units) {
  const auto end = std::ranges::find_if_not(text, [](char c) { return is_digit(c) || c == '.'; });
  const std::string_view number = text.substr(0, static_cast<std::size_t>(end - text.begin()));
  std::string_view name = text.substr(number.size());
  while (name.starts_with(' ')) name.remove_prefix(1);
  std::optional<Decimal> decimal = read_decimal(number);
  if (!decimal) throw BadValue{fmt::format("'{}' is not a number with a unit", text)};
  if (name.empty()) throw BadValue{fmt::format("'{}' has no unit (one of {})", text, names_of_units(units))};
  const auto unit = std::ranges::find(units, name, &MeasureUnit::name);
  if (unit == units.end()) {
    throw BadValue{fmt::format("'{}' has the unknown unit '{}' (not one of {})", text, name, names_of_units(units))};
  }
  std::uint64_t factor = unit->factor;
  for (; decimal->fraction_digits > 0; --decimal->fraction_digits) {
    if (!divide_out(decimal->digits, factor, 2) || !divide_out(decimal->digits, factor, 5)) {
      throw BadValue{fmt::format("'{}' is not a whole number of {}", text, units.front().name)};
    }
  }
  if (decimal->digits > std::numeric_limits<std::uint64_t>::max() / factor) {
    throw BadValue{fmt::format("'{}' is too large", text)};
  }
  return decimal->digits * factor;
}

std::string quantity_text(std::uint64_t base_units, std::span<const MeasureUnit> units) {
  if (base_units == 0) return fmt::format("0 {}", units.front().name);
  auto unit = units.rbegin();
  while (base_units % unit->factor != 0) ++unit;  // the loop ends at the latest at the smallest unit, whose factor is 1
  return fmt::format("{} {}", base_units / unit->factor, unit->name);
}

}  // namespace sim
