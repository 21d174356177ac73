#include "sim/report/thermal.h"

#include <cmath>

#include <gtest/gtest.h>

namespace sim::test {
namespace {

ThermalConfig config() {
  ThermalConfig c;
  c.ambient = 20;
  c.die_resistance = 8, c.die_capacity = 0.5;
  c.body_resistance = 4, c.body_capacity = 100;
  return c;
}

TEST(ThermalNetwork, SteadyTemperaturesAreHeatTimesResistance) {
  const Temperatures t = ThermalNetwork(config()).steady_temperatures({2, 1});
  EXPECT_DOUBLE_EQ(t.body, 20 + 4 * 3);
  EXPECT_DOUBLE_EQ(t.die, 20 + 4 * 3 + 8 * 2);
}

TEST(ThermalNetwork, ReachesItsSteadyTemperaturesAndStaysThere) {
  const ThermalNetwork network(config());
  const Temperatures end = network.steady_temperatures({2, 1});
  const Temperatures reached = network.temperatures_after({20, 20}, {2, 1}, network.decay_over(1e5));
  EXPECT_NEAR(reached.die, end.die, 1e-9);
  EXPECT_NEAR(reached.body, end.body, 1e-9);
  const Temperatures later = network.temperatures_after(end, {2, 1}, network.decay_over(7));
  EXPECT_NEAR(later.die, end.die, 1e-12);
}

TEST(ThermalNetwork, OfADieOnABodyThatHoldsItsTemperatureGoes63PercentInATimeConstant) {
  ThermalConfig c = config();
  c.body_capacity = 1e6;
  const ThermalNetwork network(c);
  EXPECT_DOUBLE_EQ(network.die_time_constant(), 4);
  const Temperatures t = network.temperatures_after({20, 20}, {2, 0}, network.decay_over(4));
  EXPECT_NEAR((t.die - 20) / 16, 1 - std::exp(-1), 1e-4);
}

TEST(ThermalNetwork, OfABodyWithoutADieGoes63PercentInATimeConstant) {
  ThermalConfig c = config();
  c.die_capacity = 1e-4;
  c.die_resistance = 1000;
  const ThermalNetwork network(c);
  EXPECT_NEAR(network.body_time_constant(), 400, 2);
  const Temperatures t = network.temperatures_after({20, 20}, {0, 5}, network.decay_over(400));
  EXPECT_NEAR((t.body - 20) / 20, 1 - std::exp(-1), 1e-3);
}

/// Reference temperatures by Euler's method with small steps.
TEST(ThermalNetwork, IsTheLimitOfSmallSteps) {
  const ThermalConfig c = config();
  const ThermalNetwork network(c);
  Temperatures euler{20, 20};
  constexpr double kStep = 1e-4;
  for (double t = 0; t < 20; t += kStep) {
    const double flow = (euler.die - euler.body) / c.die_resistance;
    euler = {euler.die + kStep * (2 - flow) / c.die_capacity,
             euler.body + kStep * (1 + flow - (euler.body - c.ambient) / c.body_resistance) / c.body_capacity};
  }
  const Temperatures exact = network.temperatures_after({20, 20}, {2, 1}, network.decay_over(20));
  EXPECT_NEAR(exact.die, euler.die, 1e-3);
  EXPECT_NEAR(exact.body, euler.body, 1e-3);
}

TEST(ThermalNetwork, TwoTimesAreTheirSum) {
  const ThermalNetwork network(config());
  const Temperatures middle = network.temperatures_after({70, 30}, {1, 2}, network.decay_over(3));
  const Temperatures end = network.temperatures_after(middle, {1, 2}, network.decay_over(11));
  const Temperatures whole = network.temperatures_after({70, 30}, {1, 2}, network.decay_over(14));
  EXPECT_NEAR(end.die, whole.die, 1e-9);
  EXPECT_NEAR(end.body, whole.body, 1e-9);
}

TEST(ThermalNetwork, WithLeakageIsSteadyWhereLeakageAndTemperatureAgree) {
  const ThermalNetwork network(config());
  const auto t = network.steady_with_leakage({2, 1}, 0.1, 50, 25);
  ASSERT_TRUE(t);
  const double leakage = 0.1 * std::exp2((t->die - 50) / 25);
  EXPECT_NEAR(t->die, network.steady_temperatures({2 + leakage, 1}).die, 1e-6);
  EXPECT_GT(leakage, 0.1 * std::exp2((network.steady_temperatures({2, 1}).die - 50) / 25)) << "it warms itself";
}

TEST(ThermalNetwork, WithMuchLeakageRunsAway) {
  EXPECT_FALSE(ThermalNetwork(config()).steady_with_leakage({2, 1}, 5, 50, 25));
}

}  // namespace
}  // namespace sim::test
