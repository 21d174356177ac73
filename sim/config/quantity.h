#pragma once
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

namespace sim {

/// A unit of measure and its size in base units (hertz, bytes, femtoseconds).
struct MeasureUnit {
  std::string_view name;
  std::uint64_t factor;
};

/// Returns the units of frequencies, in increasing order. The first unit has factor 1.
std::span<const MeasureUnit> frequency_units();
std::span<const MeasureUnit> byte_units();
std::span<const MeasureUnit> duration_units();

/// Returns the names of units as a text, such as "Hz, kHz, MHz, GHz".
std::string names_of_units(std::span<const MeasureUnit> units, std::string_view separator = ", ");

/// Converts a text such as "1.5 KiB" exactly to base units. Throws BadValue if the text is not a decimal number with
/// one of the units, or if the result is not a whole number or exceeds 64 bits.
std::uint64_t read_quantity(std::string_view text, std::span<const MeasureUnit> units);

/// Returns a quantity as text: a whole number of the largest unit for which it is whole.
std::string quantity_text(std::uint64_t base_units, std::span<const MeasureUnit> units);

}  // namespace sim
