#include "sim/report/table.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <utility>

#include <fmt/format.h>

namespace sim {
namespace {

/// Returns the number of characters (not bytes) of a UTF-8 text.
std::size_t character_count(std::string_view text) {
  return static_cast<std::size_t>(std::ranges::count_if(text, [](char c) { return (c & 0xc0) != 0x80; }));
}

/// Returns the decimal exponent of a number rounded to `digits` digits: 999.9 in three digits is 1.00e3.
int exponent_of(double value, int digits) {
  const std::string rounded = fmt::format("{:.{}e}", value, digits - 1);
  int exponent = 0;
  const char* power = rounded.data() + rounded.find('e') + 1;
  std::from_chars(*power == '+' ? power + 1 : power, rounded.data() + rounded.size(), exponent);
  return exponent;
}

/// Returns a number as text with `digits` digits, and its metric prefix. One to three digits are before the point.
std::pair<std::string, std::string_view> metric_text(double value, int digits) {
  constexpr std::string_view kPrefixes[] = {"f", "p", "n", "u", "m", "", "k", "M", "G", "T", "P"};
  constexpr int kNone = 5;
  const int exponent = exponent_of(value, digits);
  const int group = std::clamp((exponent + 3 * kNone) / 3 - kNone, -kNone, kNone);
  const int decimals = std::clamp(digits - 1 - (exponent - 3 * group), 0, digits - 1);
  return {fmt::format("{:.{}f}", value / std::pow(10.0, 3 * group), decimals), kPrefixes[group + kNone]};
}

/// True if a table cell begins with a number, such as "12.3 k", "-0.5 %", "x1.24" or "± 2 %".
bool begins_with_number(std::string_view cell) {
  const std::size_t digit = cell.find_first_of("0123456789");
  return digit != std::string_view::npos &&
         cell.substr(0, digit).find_first_not_of("+-x.±( ") == std::string_view::npos;
}

}  // namespace

std::string si_text(double value, std::string_view unit) {
  const auto with_unit = [&](std::string number, std::string_view prefix) {
    if (!prefix.empty() || !unit.empty()) number.append(" ").append(prefix).append(unit);
    return number;
  };
  const bool whole = value == std::trunc(value) && std::abs(value) < 1000;
  if (whole || !std::isfinite(value)) return with_unit(fmt::format("{}", value), {});
  if (unit.empty() && std::abs(value) < 1 && std::abs(value) >= 1e-3)
    return fmt::format("{:#.3g}", value);  // ratios
                                           // have no
                                           // prefix
  const auto [number, prefix] = metric_text(value, 3);
  return with_unit(number, prefix);
}

std::string four_digit_text(double value) {
  constexpr int kDigits = 4;
  if (value == 0 || !std::isfinite(value)) return fmt::format("{}", value);
  const int exponent = exponent_of(value, kDigits);
  if (exponent < -3) return fmt::format("{:.{}g}", value, kDigits);
  if (exponent < kDigits) return fmt::format("{:.{}f}", value, kDigits - 1 - exponent);
  const auto [number, prefix] = metric_text(value, kDigits);
  return fmt::format("{} {}", number, prefix);
}

std::string Table::text() const {
  std::vector<std::size_t> widths;
  // For each column, the number of cells with numbers minus the number of cells with words. The first column has names.
  std::vector<int> numbers = {-1};
  for (const auto& row : rows_) {
    widths.resize(std::max(widths.size(), row.size()));
    numbers.resize(widths.size());
    for (std::size_t i = 0; i < row.size(); ++i) {
      widths[i] = std::max(widths[i], character_count(row[i]));
      if (i > 0 && &row != &rows_.front() && row[i].find_first_not_of("-") != std::string::npos)
        numbers[i] += begins_with_number(row[i]) ? 1 : -1;
    }
  }
  std::string text;
  const auto end_line = [&text] {
    text.erase(text.find_last_not_of(' ') + 1);
    text += '\n';
  };
  for (const auto& row : rows_) {
    for (std::size_t i = 0; i < row.size(); ++i) {
      const std::string blanks(widths[i] - character_count(row[i]), ' ');
      text += (i == 0 ? "" : "  ");
      text += numbers[i] > 0 ? blanks + row[i] : row[i] + blanks;
    }
    end_line();
    if (&row == &rows_.front()) {
      for (std::size_t i = 0; i < widths.size(); ++i) text += (i == 0 ? "" : "  ") + std::string(widths[i], '-');
      end_line();
    }
  }
  return text;
}

}  // namespace sim
