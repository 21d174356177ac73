#include "tools/studies/sweep/spec/magnitude.h"

#include <charconv>

#include "sim/config/quantity.h"
#include "sim/config/value.h"

namespace tools::sweep {

std::optional<Magnitude> magnitude_of(std::string_view text) {
  double number = 0;
  const auto [end, bad] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (bad == std::errc{} && end == text.data() + text.size()) return Magnitude{Magnitude::Kind::kNumber, number};
  if (text.find_first_of("0123456789.") != 0) return std::nullopt;
  for (const auto& [kind, units] : {std::pair{Magnitude::Kind::kFrequency, sim::frequency_units()},
                                    {Magnitude::Kind::kBytes, sim::byte_units()},
                                    {Magnitude::Kind::kTime, sim::duration_units()}}) {
    try {
      return Magnitude{kind, static_cast<double>(sim::read_quantity(text, units))};
    } catch (const sim::BadValue&) {
    }
  }
  return std::nullopt;
}

}  // namespace tools::sweep
