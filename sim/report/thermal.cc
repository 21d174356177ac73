#include "sim/report/thermal.h"

#include <cmath>

namespace sim {

Temperatures ThermalNetwork::steady_temperatures(const HeatFlow& heat) const {
  const double body = config_.ambient + config_.body_resistance * (heat.die + heat.body);
  return {body + config_.die_resistance * heat.die, body};
}

ThermalNetwork::Decay ThermalNetwork::decay_over(double seconds) const {
  // The time derivative of the distances from the steady temperatures is this matrix times the distances.
  const double between = 1 / config_.die_resistance;
  const double a = -between / config_.die_capacity, b = -a;
  const double c = between / config_.body_capacity;
  const double d = -(between + 1 / config_.body_resistance) / config_.body_capacity;
  const double middle = (a + d) / 2, half = std::sqrt((a - d) * (a - d) / 4 + b * c);  // eigenvalues of the matrix:
                                                                                       // middle +- half
  const double slow = std::exp((middle + half) * seconds), fast = std::exp((middle - half) * seconds);
  const double even = (slow + fast) / 2, odd = (slow - fast) / (2 * half);
  return {even + odd * (a - middle), odd * b, odd * c, even + odd * (d - middle)};
}

Temperatures ThermalNetwork::temperatures_after(const Temperatures& from, const HeatFlow& heat,
                                                const Decay& decay) const {
  const Temperatures end = steady_temperatures(heat);
  const double die = from.die - end.die, body = from.body - end.body;
  return {end.die + decay.die_of_die * die + decay.die_of_body * body,
          end.body + decay.body_of_die * die + decay.body_of_body * body};
}

double ThermalNetwork::body_time_constant() const {
  return config_.body_capacity / (1 / config_.die_resistance + 1 / config_.body_resistance);
}

std::optional<Temperatures> ThermalNetwork::steady_with_leakage(const HeatFlow& heat, double leakage_w,
                                                                double nominal_c, double doubling_k) const {
  constexpr double kRunaway = 1000;  // die temperature that counts as thermal runaway, in C
  constexpr int kMostSteps = 10'000;
  Temperatures at = steady_temperatures(heat);
  for (int i = 0; i < kMostSteps; ++i) {
    const double leakage = leakage_w * std::exp2((at.die - nominal_c) / doubling_k);
    const Temperatures next = steady_temperatures({heat.die + leakage, heat.body});
    if (next.die > kRunaway) return std::nullopt;
    if (std::abs(next.die - at.die) < 1e-9) return next;
    at = next;
  }
  return std::nullopt;
}

}  // namespace sim
