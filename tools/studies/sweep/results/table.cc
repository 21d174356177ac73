#include "tools/studies/sweep/results/table.h"

#include <algorithm>
#include <charconv>
#include <cmath>

#include <fmt/format.h>

#include "sim/error.h"
#include "sim/io/printable.h"
#include "sim/report/table.h"
#include "tools/analysis/report_paths.h"
#include "tools/studies/sweep/results/figure_noise.h"

namespace tools::results {
namespace {

bool is_number(std::string_view text) {
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc{} && end == text.data() + text.size();
}

/// True if a spreadsheet would run the text as a formula.
bool is_formula(std::string_view text) {
  constexpr std::string_view kFirst = "=+-@\t\r";
  return !text.empty() && kFirst.find(text.front()) != std::string_view::npos && !is_number(text);
}

}  // namespace

std::string csv_cell(std::string_view text) {
  std::string plain = is_formula(text) ? "'" : "";
  plain += text;
  if (plain.find_first_of(",\"\r\n") == std::string::npos) return plain;
  std::string cell(1, '"');
  for (const char c : plain) cell.append(c == '"' ? 2 : 1, c);
  cell += '"';
  return cell;
}

std::string csv_line(const std::vector<std::string>& cells) {
  std::string line;
  for (const std::string& cell : cells) {
    if (&cell != &cells.front()) line += ',';
    line += csv_cell(cell);
  }
  line += '\n';
  return line;
}

namespace {

constexpr int kDigits = 4;

/// Returns the power of ten of a number, rounded as it is shown.
int exponent_of(double number) {
  const std::string text = fmt::format("{:.{}e}", number, kDigits - 1);
  const char* digits = text.data() + text.find('e') + 1;
  int exponent = 0;
  std::from_chars(*digits == '+' ? digits + 1 : digits, text.data() + text.size(), exponent);
  return exponent;
}

/// Writes a number without a prefix: a count in full.
std::string plain_text(double number, bool is_count) {
  return is_count && std::abs(number) < 10'000 ? fmt::format("{:.0f}", number) : sim::four_digits(number);
}

/// The metric prefix that the numbers of a column share: that of the largest, if it has more than four digits.
class SharedPrefix {
 public:
  void add_number(double number) { largest_ = std::max(largest_, exponent_of(number)); }

  std::string text(double number, bool is_count) const {
    constexpr std::string_view kPrefixes[] = {"", "k", "M", "G", "T", "P"};
    if (largest_ < kDigits) return plain_text(number, is_count);
    const int group = std::min(largest_ / 3, 5);
    if (number == 0 || exponent_of(number) < 3 * group - 1)
      return plain_text(number, is_count);  // too small for the prefix
    return fmt::format("{} {}", sim::four_digits(number / std::pow(10.0, 3 * group)), kPrefixes[group]);
  }

 private:
  int largest_ = 0;
};

/// `shortens`: whole numbers are figures, shown with four digits, and no names or settings.
std::vector<std::string> cells_of(const std::vector<Value>& values, bool shortens) {
  const auto number_in = [&](const Value& value) -> std::optional<double> {
    if (const auto* real = std::get_if<double>(&value)) return *real;
    const auto* count = std::get_if<std::int64_t>(&value);
    return count != nullptr && shortens ? std::optional(static_cast<double>(*count)) : std::nullopt;
  };
  SharedPrefix prefix;
  for (const Value& value : values) {
    if (const auto number = number_in(value)) prefix.add_number(*number);
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

std::string number_text(double number) { return plain_text(number, number == std::trunc(number)); }

std::vector<std::string> shown_cells(const std::vector<Value>& values) { return cells_of(values, false); }

std::vector<std::string> shown_cells(const Column& column, const std::vector<std::size_t>& rows) {
  std::vector<Value> values;
  for (const std::size_t row : rows) values.push_back(column.values[row]);
  return cells_of(values, is_total(column.name));
}

std::string shown_name(const Column& column) { return sim::printable(metric_name(column.name)); }

namespace {

/// Figures that are shown unless columns are given.
constexpr const char* kUsualColumns[] = {"cycles", "perf.fps", "energy_mj.nominal", "power_w.nominal",
                                         "perf.frames_per_joule_gpu"};

/// Columns of a figure in CSV: mean and interval if there are replicates, else the figure.
std::vector<std::string> statistics_of(const Results& results, const std::string& figure) {
  const std::string at = fmt::format("totals.replicates.figures.{}.", figure);
  if (!results.has_metric(at + "mean")) return {figure};
  return {at + "mean", at + "low", at + "high"};
}

std::vector<std::string> usual_columns(const Results& results, bool csv) {
  std::vector<std::string> names = {"n", "status"};
  for (const Column& column : results.varying_axes()) names.push_back(column.name);
  for (const char* metric : kUsualColumns) {
    if (!results.has_metric(fmt::format("totals.{}", metric))) continue;
    for (std::string& name : csv ? statistics_of(results, metric) : std::vector<std::string>{metric}) {
      names.push_back(std::move(name));
    }
  }
  constexpr const char* kExtrapolated = "totals.extrapolated";
  const auto some = [](const Value& value) { return !is_absent(value) && exact_text(value) != "0"; };
  if (results.has_metric(kExtrapolated) && std::ranges::any_of(results.column(kExtrapolated).values, some)) {
    names.emplace_back("extrapolated");
  }
  return names;
}

/// Replaces values by "771200 ± 0.52 %" if all points that are done have replicates of the figure.
Column with_interval(const Results& results, Column column) {
  if (!results.has_metric("totals.replicates.count")) return column;
  std::vector<std::size_t> done;
  for (std::size_t row = 0; row < results.rows().size(); ++row) {
    if (results.rows()[row].is_done() && !is_absent(column.values[row])) done.push_back(row);
  }
  const FigureNoise noise(results, column, done);
  if (!noise.is_measured()) return column;
  const std::vector<std::string> means = shown_cells(noise.means(), done);
  for (std::size_t i = 0; i < done.size(); ++i) {
    column.values[done[i]] = fmt::format("{} {}", means[i], interval_text(noise, done[i]));
  }
  return column;
}

/// Sorts rows by "column" or "column:desc". Absent values come last in both orders.
void sort_rows(std::vector<std::size_t>& rows, const Results& results, const std::string& text) {
  const std::size_t colon = text.rfind(':');
  const std::string order = colon == std::string::npos ? "asc" : text.substr(colon + 1);
  if (order != "asc" && order != "desc") {
    throw sim::InputError(fmt::format("--sort '{}': the order '{}' is unknown; allowed: asc, desc",
                                      sim::printable(text), sim::printable(order)));
  }
  const Column column = column_of_means(results, text.substr(0, colon));
  std::ranges::stable_sort(rows, [&](std::size_t a, std::size_t b) {
    const Value &x = column.values[a], &y = column.values[b];
    if (is_absent(x) || is_absent(y)) return !is_absent(x) && is_absent(y);
    return order == "asc" ? is_before(x, y) : is_before(y, x);
  });
}

}  // namespace

std::string table_text(const std::vector<std::string>& names, const std::vector<Column>& columns,
                       const std::vector<std::size_t>& rows, bool csv) {
  std::vector<std::vector<std::string>> cells;
  for (const Column& column : columns) {
    if (!csv) {
      cells.push_back(shown_cells(column, rows));
      continue;
    }
    cells.emplace_back();
    for (const std::size_t row : rows) cells.back().push_back(exact_text(column.values[row]));
  }
  sim::Table table(names);
  std::string lines = csv_line(names);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    std::vector<std::string> row;
    for (std::vector<std::string>& column : cells) row.push_back(std::move(column[i]));
    if (csv) {
      lines += csv_line(row);
    } else {
      table.add_row(std::move(row));
    }
  }
  return csv ? lines : table.text();
}

std::string results_table(const Results& results, const TableOptions& options) {
  const std::vector<std::string> asked =
      options.columns.empty() ? usual_columns(results, options.csv) : options.columns;
  std::vector<std::string> names;
  std::vector<Column> columns;
  for (const std::string& name : asked) {
    columns.push_back(results.column(name));
    if (!options.csv) columns.back() = with_interval(results, std::move(columns.back()));
    names.push_back(options.csv ? columns.back().name : shown_name(columns.back()));
  }
  const std::vector<bool> met = rows_meeting(results, options.where);
  std::vector<std::size_t> rows;
  for (std::size_t i = 0; i < met.size(); ++i) {
    if (met[i]) rows.push_back(i);
  }
  if (!options.sort.empty()) sort_rows(rows, results, options.sort);
  if (options.limit && rows.size() > *options.limit) rows.resize(*options.limit);
  const bool is_empty = rows.empty() && !options.where.empty() && !options.csv;
  return table_text(names, columns, rows, options.csv) + (is_empty ? "no point meets --where\n" : "");
}

}  // namespace tools::results
