#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "hw_models/dram/dram_config.h"

namespace hw {

/// A figure of a channel, measured on requests made for it, beside its closed form.
struct DramMeasurement {
  /// How the two compare.
  enum class Holds : std::uint8_t {
    kExactly,
    kClosely,  ///< within 2 %
    kNearly,   ///< between nine tenths of the form and all of it
    kAtMost,   ///< the form is a bound that leaves out command slots and waiting banks (2 % for ends)
  };
  std::string name;
  std::string unit;  ///< "ns", "GB/s", "pJ/bit" or "mW"
  double measured = 0;
  double expected = 0;
  Holds holds = Holds::kExactly;

  bool good() const;
};

/// Returns the times and bandwidths of a speed grade: its organisation and timing, under a controller that leaves rows
/// open, neither refreshes nor powers down and maps addresses as each figure needs it; then dram_energy_measurements().
std::vector<DramMeasurement> dram_measurements(const DramConfig& grade);

/// Returns the nominal energy of a channel as configured, all its ranks and refreshes included: per bit of a stream and
/// of random reads, and idle, as power and per bit that the idle bus could have moved.
std::vector<DramMeasurement> dram_energy_measurements(const DramConfig& grade);

}  // namespace hw
