#pragma once
#include <array>
#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "sim/config/field.h"
#include "sim/named.h"

namespace sim {

/// Selects the voltage for which energies are computed.
enum class Voltage : std::uint8_t {
  kNominal,  ///< the voltage of the energy table, for any clock frequency
  kDvfs,     ///< the voltage that each clock domain needs for its frequency
};
constexpr std::array<std::string_view, 2> names_of(Voltage) { return {"nominal", "dvfs"}; }

/// Power state of the chip between frames.
enum class ChipIdle : std::uint8_t {
  kPowerGated,  ///< supply off; the fraction `idle_leakage` of the leakage remains
  kClockGated,  ///< supply on, clocks off: all leakage remains
  kClocked,     ///< supply and clocks on: all leakage, and the clock energy of idle units
};
constexpr std::array<std::string_view, 3> names_of(ChipIdle) { return {"power_gated", "clock_gated", "clocked"}; }

/// Operating conditions of the chip, such as voltage and temperature: one file of configs/power. The defaults do not
/// scale energies.
struct PowerConfig {
  std::string process = "unnamed";
  Voltage voltage = Voltage::kNominal;
  std::map<std::string, Band> dvfs;
  double nominal_voltage = 0.8;
  double max_voltage = 5;
  double temperature = 75, nominal_temperature = 75;
  double leakage_exponent = 3;
  double leakage_doubling = 25;
  ChipIdle idle = ChipIdle::kPowerGated;
  double idle_leakage = 0.03;

  static void describe(auto& c, auto&& field) {
    const auto power = [&](auto& value, const char* name, const char* unit, const char* meaning, Limits limits) {
      field(value, name, unit, meaning, limits, Affects::kEnergy);
    };
    power(NAMED(c.process), "", "technology of the table", any());
    power(NAMED(c.voltage), "",
          "voltage used for energies: that of the energy table at any clock, or the one that each clock needs by dvfs",
          any());
    power(NAMED(c.dvfs), "V", "voltage that a clock domain needs for a frequency, as tni@500MHz: points of a curve",
          at_least(0));
    power(NAMED(c.nominal_voltage), "V", "voltage of the energy table", between(0.1, 5));
    power(NAMED(c.max_voltage), "V", "highest voltage that the process allows; a clock that needs more is a warning",
          between(0.1, 5));
    power(NAMED(c.temperature), "C", "temperature of the chip, for leakage", between(-40, 150));
    power(NAMED(c.nominal_temperature), "C", "temperature of the energy table", between(-40, 150));
    power(NAMED(c.leakage_exponent), "", "power of the voltage with which leakage grows", between(0, 20));
    power(NAMED(c.leakage_doubling), "C", "rise of temperature that doubles leakage", between(1, 1000));
    power(NAMED(c.idle), "",
          "state of the chip between frames: without supply, without clocks, or with the clocks of idle units", any());
    power(NAMED(c.idle_leakage), "", "share of the leakage that remains between frames with idle power_gated",
          between(0, 1));
  }
  void check(auto&& complain) const {
    for (const auto& [name, volt] : dvfs) {
      if (volt.low != volt.high || volt.low <= 0) {
        complain("dvfs", "'" + name + "' is no voltage; allowed: one number of volts, more than 0");
      }
    }
  }
};

/// Factors that are applied to the energies of a block from the energy table. Energies of external devices (DRAM) are
/// not scaled.
struct PowerScale {
  double dynamic = 1, leakage = 1;
};
/// Scale factors by block name. Blocks that are absent have factors of 1.
using PowerScales = std::map<std::string, PowerScale>;

/// Voltage of a clock domain as a function of its frequency: linear between points, constant below the lowest point,
/// extrapolated above the highest.
class VoltageCurve {
 public:
  double voltage_at(std::uint64_t hz) const;
  std::uint64_t least_hz() const { return points_.front().hz; }
  std::uint64_t most_hz() const { return points_.back().hz; }

 private:
  friend std::map<std::string, VoltageCurve> voltage_curves(const PowerConfig& config);
  struct Point {
    std::uint64_t hz;
    double volt;
  };
  std::vector<Point> points_;  ///< points of the curve by increasing frequency
};

/// Returns the voltage curve of each clock domain in `config.dvfs`. Throws InputError for an entry without a frequency,
/// or a voltage that decreases with frequency.
std::map<std::string, VoltageCurve> voltage_curves(const PowerConfig& config);

/// Returns the energy factors for a voltage. Dynamic energy grows with the square of the voltage. Leakage grows with a
/// power of the voltage, and doubles every `leakage_doubling` degrees.
PowerScale power_scale(const PowerConfig& config, double volt);

}  // namespace sim
