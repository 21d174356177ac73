#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

namespace tools::sweep {

/// A number with or without a unit.
struct Magnitude {
  enum class Kind : std::uint8_t { kNumber, kFrequency, kBytes, kTime } kind = Kind::kNumber;
  double value = 0;  ///< value in base units: hertz, bytes, femtoseconds
};
/// Parses a number with or without a unit, such as "2", "8 KiB" or "500 MHz". Returns nothing for other text.
std::optional<Magnitude> parse_magnitude(std::string_view text);

/// A value of an axis or a metric: absent, a whole number, a real number or a text.
using Value = std::variant<std::monostate, std::int64_t, double, std::string>;

inline bool is_absent(const Value& value) { return std::holds_alternative<std::monostate>(value); }
/// Returns a value as text: numbers with the fewest decimals that read back exactly, "" for an absent value.
std::string exact_text(const Value& value);
/// Returns the magnitude of a value that is a number or a text such as "8 KiB"; nothing for other values.
std::optional<Magnitude> magnitude_of(const Value& value);
/// True if `a` precedes `b` in a sorted column. Numbers come first, in ascending order, then texts, then absent values.
bool sorts_before(const Value& a, const Value& b);

// The language of conditions in a sweep's file (`exclude`, `where`) and on the command line (`--where`).

enum class Comparison : std::uint8_t { kEqual, kUnequal, kLess, kLessEqual, kGreater, kGreaterEqual };
/// True for <, <=, > and >=, which only ordered values allow.
inline bool needs_order(Comparison comparison) {
  return comparison != Comparison::kEqual && comparison != Comparison::kUnequal;
}

/// A side of a comparison: its text, and its magnitude if it is a number.
struct Operand {
  std::string text;
  std::optional<Magnitude> magnitude;

  Operand() = default;
  explicit Operand(std::string of) : text(std::move(of)), magnitude(parse_magnitude(text)) {}
  explicit Operand(const Value& value) : text(exact_text(value)), magnitude(magnitude_of(value)) {}
};

/// Compares two values: two numbers by magnitude, all others by text. Returns nothing for numbers with units of
/// different kinds, and for <, <=, > or >= unless both are numbers.
std::optional<bool> compare(const Operand& left, Comparison comparison, const Operand& right);

/// One comparison of a condition, before names are looked up.
struct ConditionTerm {
  std::string name;  ///< an axis, a configuration key, a report path, or a function of a path, such as worst(fps)
  Comparison comparison = Comparison::kEqual;
  std::string value;
};

/// Splits a text such as "<= 8 KiB" into comparison and value. Text without a comparison sign means =. The value may be
/// empty.
std::pair<Comparison, std::string> parse_comparison(const std::string& text);

/// Parses "worst(power_w)<1 and tni.trv.l1.size>='16 KiB'". Throws InputError with the column of the error.
std::vector<ConditionTerm> parse_condition(const std::string& text);

}  // namespace tools::sweep
