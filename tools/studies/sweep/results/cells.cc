#include "tools/studies/sweep/results/cells.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <optional>

#include <fmt/format.h>

#include "sim/io/printable.h"
#include "sim/report/table.h"

namespace tools::results {
namespace {

constexpr int kDigits = 4, kMostDecimals = 6;

/// The power of ten of a number as it is shown.
int exponent_of(double number) {
  const std::string text = fmt::format("{:.{}e}", number, kDigits - 1);
  const char* digits = text.data() + text.find('e') + 1;
  int exponent = 0;
  std::from_chars(*digits == '+' ? digits + 1 : digits, text.data() + text.size(), exponent);
  return exponent;
}

/// For a number, or a column of them of which this is the smallest.
std::string fixed(double number, int smallest) {
  if (exponent_of(number) >= kDigits) return sim::four_digits(number);
  if (smallest < kDigits - 1 - kMostDecimals) return fmt::format("{:.{}g}", number, kDigits);
  return fmt::format("{:.{}f}", number, std::clamp(kDigits - 1 - smallest, 0, kMostDecimals));
}

}  // namespace

std::string shown(double number) {
  if (number == std::trunc(number) && std::abs(number) < 1e15) return fmt::format("{:.0f}", number);
  return fixed(number, exponent_of(number));
}

std::vector<std::string> shown_cells(const std::vector<Value>& values) {
  std::optional<int> smallest;
  for (const Value& value : values) {
    const auto* real = std::get_if<double>(&value);
    if (real != nullptr && *real != 0) smallest = std::min(smallest.value_or(kDigits), exponent_of(*real));
  }
  std::vector<std::string> cells;
  for (const Value& value : values) {
    const auto* real = std::get_if<double>(&value);
    if (real != nullptr) {
      cells.push_back(fixed(*real, smallest.value_or(kDigits)));
    } else {
      cells.push_back(is_absent(value) ? "-" : sim::printable(exact_text(value)));
    }
  }
  return cells;
}

}  // namespace tools::results
