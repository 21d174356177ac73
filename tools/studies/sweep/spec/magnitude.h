#pragma once
#include <optional>
#include <string>
#include <string_view>

namespace tools::sweep {

/// A number with a unit, or without.
struct Magnitude {
  enum class Kind { kNumber, kFrequency, kBytes, kTime } kind = Kind::kNumber;
  double value = 0;  ///< in base units: hertz, bytes, femtoseconds
};

/// Nothing for any other text.
std::optional<Magnitude> magnitude_of(std::string_view text);

}  // namespace tools::sweep
