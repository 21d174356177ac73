#pragma once
#include <string>
#include <string_view>
#include <vector>

namespace sim {

/// Returns a number as text with a metric prefix and three digits: "12.3 M", "950", "4.56 mJ". Whole numbers below 1000
/// have no decimals. Without a unit, numbers below 1 have no prefix: "0.335".
std::string si_text(double value, std::string_view unit = {});

/// Returns a number as text with at most four digits: "4733", "350.0", "12.82 k", "0.1203", "8.46e-05".
std::string four_digit_text(double value);

/// A table of text for terminals. A column is as wide as its widest cell. The first column and columns of words are
/// left-aligned, columns of numbers right-aligned.
class Table {
 public:
  explicit Table(std::vector<std::string> header) : rows_{std::move(header)} {}

  /// Adds a row to the text table. It may have fewer cells than the header.
  void add_row(std::vector<std::string> cells) { rows_.push_back(std::move(cells)); }
  /// Returns the text of the table. Each line ends with a line feed and has no trailing blanks.
  std::string text() const;

 private:
  std::vector<std::vector<std::string>> rows_;
};

/// Factors for converting the units of counters to those of reports.
inline constexpr double kFemtosecondsPerNs = 1e6;
inline constexpr double kFemtosecondsPerMicrosecond = 1e9;
inline constexpr double kFemtosecondsPerMillisecond = 1e12;
inline constexpr double kPicojoulesPerMillijoule = 1e9;
inline constexpr double kWattsPerPicojouleOverFemtosecond = 1e3;

}  // namespace sim
