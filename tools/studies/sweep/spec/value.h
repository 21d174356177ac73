#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <variant>

namespace tools::sweep {

/// A number with or without a unit.
struct Magnitude {
  enum class Kind : std::uint8_t { kNumber, kFrequency, kBytes, kTime } kind = Kind::kNumber;
  double value = 0;  ///< in base units: hertz, bytes, femtoseconds
};
/// Reads "2", "8 KiB", "500 MHz"; nothing for any other text.
std::optional<Magnitude> magnitude_of(std::string_view text);

/// A value of an axis or a figure: absent, a whole number, a real number or a text.
using Value = std::variant<std::monostate, std::int64_t, double, std::string>;

inline bool is_absent(const Value& value) { return std::holds_alternative<std::monostate>(value); }
/// Returns the text, the shortest decimals that read back exactly, or "".
std::string exact_text(const Value& value);
/// Returns the magnitude of a number, or of a text that is one and finite.
std::optional<Magnitude> amount_of(const Value& value);
/// Order of a column: numbers by amount, then texts, then absent values.
bool is_before(const Value& a, const Value& b);

}  // namespace tools::sweep
