#pragma once
#include <string>
#include <string_view>
#include <vector>

namespace sim {

/// "12.3 M", "950", "4.56 mJ": three digits with the metric prefix that leaves one to three of them before the point.
/// Whole numbers below 1000 stay whole, and ratios, which have no unit, are "0.335".
std::string si_text(double value, std::string_view unit = {});

/// A figure as people read it, in at most four digits: "4733", "350.0", "12.82 k", "0.1203", "8.46e-05".
std::string four_digits(double value);

/// A table for terminals: columns as wide as their widest cell, the first one and those of words
/// to the left, those of numbers to the right.
class Table {
 public:
  explicit Table(std::vector<std::string> header) : rows_{std::move(header)} {}

  /// Cells may be fewer than the header's.
  void row(std::vector<std::string> cells) { rows_.push_back(std::move(cells)); }
  /// Every line ends with a line end and without blanks.
  std::string text() const;

 private:
  std::vector<std::vector<std::string>> rows_;
};

}  // namespace sim
