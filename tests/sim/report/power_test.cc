#include <cmath>

#include <gtest/gtest.h>

#include "../folder.h"
#include "sim/config/config.h"
#include "sim/error.h"
#include "sim/report/energy.h"

namespace sim::test {
namespace {

constexpr std::uint64_t kMhz = 1'000'000;

PowerConfig power_config() {
  PowerConfig c;
  c.dvfs = {{"core@100MHz", {0.6, 0.6, 0.6}}, {"core@200MHz", {0.7, 0.7, 0.7}}, {"core@400MHz", {1.1, 1.1, 1.1}}};
  return c;
}

std::string error_of(const PowerConfig& c) {
  const Folder folder;
  return complaint<InputError>(folder, [&] { voltage_curves(c); });
}

TEST(VoltageCurve, IsLinearBetweenPointsConstantBelowAndExtrapolatedAbove) {
  const VoltageCurve curve = voltage_curves(power_config()).at("core");
  EXPECT_EQ(curve.voltage_at(100 * kMhz), 0.6);
  EXPECT_EQ(curve.voltage_at(200 * kMhz), 0.7);
  EXPECT_EQ(curve.voltage_at(400 * kMhz), 1.1);
  EXPECT_NEAR(curve.voltage_at(150 * kMhz), 0.65, 1e-12);
  EXPECT_NEAR(curve.voltage_at(300 * kMhz), 0.9, 1e-12);
  EXPECT_EQ(curve.voltage_at(50 * kMhz), 0.6);
  EXPECT_NEAR(curve.voltage_at(500 * kMhz), 1.3, 1e-12);
}

TEST(VoltageCurve, RefusesInvalidEntries) {
  PowerConfig c = power_config();
  c.dvfs["core@300MHz"] = {0.5, 0.5, 0.5};
  EXPECT_NE(error_of(c).find("0.7 V at 200 MHz and 0.5 V at 300 MHz"), std::string::npos) << error_of(c);
  c = power_config();
  c.dvfs["core"] = {0.5, 0.5, 0.5};
  EXPECT_NE(error_of(c).find("power.dvfs.core: "), std::string::npos) << error_of(c);
}

TEST(PowerScale, IsExactlyOneAtTheTablesVoltageAndTemperature) {
  const PowerScale scale = power_scale(power_config(), 0.8);
  EXPECT_EQ(scale.dynamic, 1);
  EXPECT_EQ(scale.leakage, 1);
}

TEST(PowerScale, FollowsTheVoltageTheExponentAndTheTemperature) {
  PowerConfig c = power_config();
  EXPECT_NEAR(power_scale(c, 0.4).dynamic, 0.25, 1e-12);
  EXPECT_NEAR(power_scale(c, 0.4).leakage, 0.125, 1e-12);
  c.temperature = 125;
  EXPECT_NEAR(power_scale(c, 0.8).leakage, 4, 1e-12);
  EXPECT_EQ(power_scale(c, 0.8).dynamic, 1);
  c.temperature = 50;
  c.leakage_exponent = 2;
  EXPECT_NEAR(power_scale(c, 1.6).leakage, 2, 1e-12);
}

/// Returns the energy of a unit with 100 KiB and 2 mm2 that counted `boxes` events of 3 pJ.
double pj(double boxes, Time time, const PowerScale& scale) {
  EnergyConfig e;
  e.events = {{"box", {3, 3, 3}}};
  e.clock_share = {0.25, 0.25, 0.25};
  e.sram_leakage = {0.02, 0.02, 0.02};
  e.logic_leakage = {10, 10, 10};
  e.logic = {{"tni", {2, 2, 2}}};
  e.flops = {{"tni", {0, 0, 0}}};
  UnitReport unit;
  unit.path = "core0.tni.trv0";
  unit.block = "tni";
  unit.sram_bytes = 100 * 1024;
  unit.counters = {{"boxes", "", static_cast<std::uint64_t>(boxes), "box", CounterKind::kSum}};
  return compute_energy(std::vector{unit}, e, {}, time, {{"tni", scale}}).total_pj.nominal;
}

// 22 mW at 0.8 V and 75 C: 22e-6 pJ per femtosecond.
TEST(LeakageAlone, IsPowerTimesTimeAtAnyVoltageAndTemperature) {
  PowerConfig c = power_config();
  constexpr Time kTime = kFemtosecondsPerSecond / 1000;
  for (const double volt : {0.4, 0.6, 0.8, 1.0}) {
    for (const double degrees : {25.0, 75.0, 100.0}) {
      c.temperature = degrees;
      const double expected =
          22e-6 * static_cast<double>(kTime) * std::pow(volt / 0.8, 3) * std::pow(2, (degrees - 75) / 25);
      EXPECT_NEAR(pj(0, kTime, power_scale(c, volt)), expected, 1e-9 * expected);
    }
  }
}

// For a fixed number of cycles at one voltage, leakage energy is proportional to time, so the fastest clock is best.
TEST(LeakageAlone, AtOneVoltageGoesWithOneOverTheClock) {
  const double slow = pj(0, 4 * kFemtosecondsPerSecond / 1000, {}), fast = pj(0, kFemtosecondsPerSecond / 1000, {});
  EXPECT_NEAR(slow / fast, 4, 1e-12);
}

TEST(DynamicAlone, GoesWithTheSquareOfTheVoltageAndNotWithTheTime) {
  const double full = pj(1000, 0, power_scale(power_config(), 0.8));
  EXPECT_NEAR(full, 3 * 1000 / 0.75, 1e-9);
  EXPECT_NEAR(pj(1000, 0, power_scale(power_config(), 0.6)), full * 0.5625, 1e-9);
}

TEST(EnergyOfADevice, DoesNotFollowTheChipsVoltage) {
  EnergyConfig e;
  e.logic = e.flops = {{"dram", {0, 0, 0}}};
  UnitReport unit;
  unit.path = "dram.channel0";
  unit.block = "dram";
  unit.counters = {{"reads", "", 10, "dram.read", CounterKind::kSum}};
  const EnergyReport report = compute_energy(std::vector{unit}, e, {{"dram.read", {{5, 5, 5}, false}}}, 1,
                                             {{"dram", power_scale(power_config(), 0.4)}});
  EXPECT_EQ(report.total_pj.nominal, 50);
  EXPECT_EQ(report.events.at("dram").at("dram.read").nominal, 50);
}

TEST(Power14nm, HasTheTablesVoltageAtTheDefaultClocks) {
  const auto curves = voltage_curves(load_config<PowerConfig>("configs/power/14nm.yaml"));
  EXPECT_EQ(curves.at("tni").voltage_at(500 * kMhz), 0.8);
  EXPECT_EQ(curves.at("srp").voltage_at(1000 * kMhz), 0.8);
  EXPECT_EQ(curves.at("l2").voltage_at(500 * kMhz), 0.8);
}

}  // namespace
}  // namespace sim::test
