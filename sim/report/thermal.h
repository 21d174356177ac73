#pragma once
#include <cstdint>
#include <optional>

#include "sim/config/field.h"
#include "sim/named.h"

namespace sim {

/// Configuration of a device's heat path and its thermal governor: one file of configs/thermal.
struct ThermalConfig {
  double minutes = 0;
  double ambient = 25;
  double die_resistance = 10, die_capacity = 0.9;
  double body_resistance = 5, body_capacity = 108;
  double other_power = 1;
  double die_limit = 95, body_limit = 43, hysteresis = 0.5;
  double period = 1, lookahead = 60;
  std::uint32_t steps = 7;
  double slowest = 0.4;

  static void describe(auto& c, auto&& field) {
    const auto thermal = [&](auto& value, const char* name, const char* unit, const char* meaning, Limits limits) {
      field(value, name, unit, meaning, limits, Affects::kEnergy);
    };
    thermal(NAMED(c.minutes), "min", "time over which a run repeats its frames in the device; 0: not at all",
            between(0, 10'000));
    thermal(NAMED(c.ambient), "C", "temperature of the air", between(-40, 60));
    thermal(NAMED(c.die_resistance), "K/W", "thermal resistance from the die to the body", between(0.01, 1000));
    thermal(NAMED(c.die_capacity), "J/K", "heat that warms the die and its package by a degree", between(1e-4, 1e4));
    thermal(NAMED(c.body_resistance), "K/W", "thermal resistance from the body to the air", between(0.01, 1000));
    thermal(NAMED(c.body_capacity), "J/K", "heat that warms the body by a degree", between(1e-3, 1e6));
    thermal(NAMED(c.other_power), "W", "heat of the rest of the device, into the body", between(0, 1000));
    thermal(NAMED(c.die_limit), "C", "temperature of the die above which the governor slows clocks", between(0, 150));
    thermal(NAMED(c.body_limit), "C", "temperature of the body above which the governor slows clocks", between(0, 150));
    thermal(NAMED(c.hysteresis), "K", "distance below both limits at which clocks rise again", between(0, 50));
    thermal(NAMED(c.period), "s", "time between decisions of the governor", between(1e-3, 1e4));
    thermal(NAMED(c.lookahead), "s", "time over which the governor extrapolates the body's temperature",
            between(0, 1e4));
    thermal(NAMED(c.steps), "steps", "clocks that the governor chooses from", between(1, 64));
    thermal(NAMED(c.slowest), "", "slowest clock, relative to the configured one; the others are evenly spaced",
            between(0.01, 1));
  }
};

/// Temperatures of the two nodes of a ThermalNetwork, die and body, in C.
struct Temperatures {
  double die = 0, body = 0;
};

/// Heat that enters each node of a ThermalNetwork, in W.
struct HeatFlow {
  double die = 0, body = 0;
};

/// Thermal network of two nodes: die -- die_resistance -- body -- body_resistance -- air. Die and body have a heat
/// capacity. Not modelled: temperature differences on the die, heat of the battery, radiation (part of
/// body_resistance).
class ThermalNetwork {
 public:
  explicit ThermalNetwork(const ThermalConfig& config) : config_(config) {}

  /// Returns the temperatures after infinite time under constant heat: ambient + heat x resistance.
  Temperatures steady_temperatures(const HeatFlow& heat) const;

  /// How the initial deviations of die and body from their steady temperatures decay over a time. `die_of_body` is the
  /// remaining deviation of the die per degree of initial deviation of the body.
  struct Decay {
    double die_of_die = 1, die_of_body = 0, body_of_die = 0, body_of_body = 1;
  };
  /// Returns the exact decay after a time in s: the matrix exponential of the thermal network.
  Decay decay_over(double seconds) const;
  /// Returns the temperatures after constant heat for the time for which `decay` was computed. `from`: initial
  /// temperatures.
  Temperatures temperatures_after(const Temperatures& from, const HeatFlow& heat, const Decay& decay) const;

  /// Time constant of the die while the temperature of the body is constant, in s.
  double die_time_constant() const { return config_.die_resistance * config_.die_capacity; }
  double body_time_constant() const;

  /// Returns the steady temperatures under constant heat plus leakage; nullopt for thermal runaway. The leakage is
  /// `leakage_w` watts at a die temperature of `nominal_c`, and doubles every `doubling_k` degrees.
  std::optional<Temperatures> steady_with_leakage(const HeatFlow& heat, double leakage_w, double nominal_c,
                                                  double doubling_k) const;

 private:
  const ThermalConfig config_;
};

}  // namespace sim
