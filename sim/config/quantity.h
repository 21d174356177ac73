#pragma once
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

namespace sim {

/// A unit of a quantity and how many base units (hertz, bytes, femtoseconds) it has.
struct Unit {
  std::string_view name;
  std::uint64_t factor;
};

/// Units from the smallest, whose factor is 1, to the largest.
std::span<const Unit> frequency_units();
std::span<const Unit> byte_units();
std::span<const Unit> duration_units();

/// "Hz, kHz, MHz, GHz"
std::string names_of_units(std::span<const Unit> units, std::string_view separator = ", ");

/// The base units of a text such as "1.5 KiB", exactly. Throws BadValue if it is no decimal number with one of the
/// units, is not a whole number of base units, or is more than 64 bits hold.
std::uint64_t read_quantity(std::string_view text, std::span<const Unit> units);

/// The quantity as a whole number of the largest unit that divides it.
std::string quantity_text(std::uint64_t base_units, std::span<const Unit> units);

}  // namespace sim
