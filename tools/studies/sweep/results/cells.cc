#include "tools/studies/sweep/results/cells.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <optional>

#include <fmt/format.h>

#include "sim/io/printable.h"
#include "sim/report/table.h"
#include "tools/analysis/report_paths.h"

namespace tools::results {
namespace {

constexpr int kDigits = 4;

/// The power of ten of a number as it is shown.
int exponent_of(double number) {
  const std::string text = fmt::format("{:.{}e}", number, kDigits - 1);
  const char* digits = text.data() + text.find('e') + 1;
  int exponent = 0;
  std::from_chars(*digits == '+' ? digits + 1 : digits, text.data() + text.size(), exponent);
  return exponent;
}

/// A number that goes without a prefix: whole if it is a count.
std::string plain(double number, bool is_count) {
  return is_count && std::abs(number) < 10'000 ? fmt::format("{:.0f}", number) : sim::four_digits(number);
}

/// Metric prefix that the numbers of a column share: that of the largest, if one has more than four digits.
class Prefix {
 public:
  void see(double number) { largest_ = std::max(largest_, exponent_of(number)); }

  std::string text(double number, bool is_count) const {
    constexpr std::string_view kPrefixes[] = {"", "k", "M", "G", "T", "P"};
    if (largest_ < kDigits) return plain(number, is_count);
    const int group = std::min(largest_ / 3, 5);
    if (number == 0 || exponent_of(number) < 3 * group - 1) return plain(number, is_count);  // too small for it
    return fmt::format("{} {}", sim::four_digits(number / std::pow(10.0, 3 * group)), kPrefixes[group]);
  }

 private:
  int largest_ = 0;
};

/// `shortens`: counts are figures, of which four digits do, and no names or settings.
std::vector<std::string> cells_of(const std::vector<Value>& values, bool shortens) {
  const auto number_in = [&](const Value& value) -> std::optional<double> {
    if (const auto* real = std::get_if<double>(&value)) return *real;
    const auto* count = std::get_if<std::int64_t>(&value);
    return count != nullptr && shortens ? std::optional(static_cast<double>(*count)) : std::nullopt;
  };
  Prefix prefix;
  for (const Value& value : values) {
    if (const auto number = number_in(value)) prefix.see(*number);
  }
  std::vector<std::string> cells;
  for (const Value& value : values) {
    const auto number = number_in(value);
    if (number) {
      cells.push_back(prefix.text(*number, std::holds_alternative<std::int64_t>(value)));
    } else {
      cells.push_back(is_absent(value) ? "-" : sim::printable(exact_text(value)));
    }
  }
  return cells;
}

}  // namespace

std::string shown(double number) { return plain(number, number == std::trunc(number)); }

std::vector<std::string> shown_cells(const std::vector<Value>& values) { return cells_of(values, false); }

std::vector<std::string> shown_cells(const Column& column, const std::vector<std::size_t>& rows) {
  std::vector<Value> values;
  for (const std::size_t row : rows) values.push_back(column.values[row]);
  return cells_of(values, is_total(column.name));
}

std::string shown_name(const Column& column) { return sim::printable(metric_name(column.name)); }

}  // namespace tools::results
