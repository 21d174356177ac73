#include "tools/run/frame/frame_rate.h"

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "hw_models/dram/dram_energy.h"
#include "hw_models/machines/gpu_config.h"
#include "tools/run/frame/machine_run.h"
#include "tools/run/frame/power.h"

// Tests of the power at a target frame rate, against closed forms.

namespace tools {
namespace {

RunConfig config_with(std::vector<std::string> sets) {
  JobOptions options;
  options.sets = std::move(sets);
  return load_run_config(options);
}

constexpr double kPicojoulesPerJoule = 1e12;

/// Returns energies with one block of the chip, in J.
sim::EnergyReport joules_of(const char* block, double dynamic, double leakage) {
  const auto band = [](double j) {
    return sim::Band{j * kPicojoulesPerJoule / 2, j * kPicojoulesPerJoule, j * kPicojoulesPerJoule * 2};
  };
  sim::EnergyReport energy;
  energy.blocks[block] = {band(dynamic), {}, band(leakage)};
  energy.kinds = energy.blocks[block];
  energy.total_pj = energy.blocks[block].total();
  return energy;
}

FrameRate rate_of(const RunConfig& config, const sim::EnergyReport& energy, double ms, double frames = 1,
                  double slowest_ms = 0) {
  const std::vector<sim::UnitReport> units = idle_unit_reports(*config.gpu);
  return evaluate_frame_rate(config, {.energy = energy,
                                      .units = units,
                                      .count = frames,
                                      .time_ms = ms,
                                      .slowest_ms = slowest_ms > 0 ? slowest_ms : ms / frames});
}

TEST(FrameRate, OfAFrameThatTakesNoTimeIsTheIdlePower) {
  const RunConfig config = config_with({"frame.fps=60"});
  const FrameRate rate = rate_of(config, joules_of("tni", 0, 0), 1e-12);
  EXPECT_TRUE(rate.is_met());
  EXPECT_NEAR(rate.power_w.nominal, rate.idle_mw.nominal / 1000, 1e-12);
  EXPECT_NEAR(rate.power_w.low, rate.idle_mw.low / 1000, 1e-12);
  EXPECT_NEAR(rate.power_w.high, rate.idle_mw.high / 1000, 1e-12);
}

TEST(FrameRate, OfFramesWithoutIdleTimeIsThePowerOfTheRun) {
  const FrameRate rate = rate_of(config_with({"frame.fps=50"}), joules_of("tni", 0.03, 0.01), 20);
  EXPECT_TRUE(rate.is_met());
  EXPECT_DOUBLE_EQ(rate.rate_margin(), 1);
  EXPECT_DOUBLE_EQ(rate.slack_ms(), 0);
  EXPECT_DOUBLE_EQ(rate.busy, 1);
  EXPECT_DOUBLE_EQ(rate.power_w.nominal, 0.04 / 20e-3);
  EXPECT_DOUBLE_EQ(rate.power_w.low, 0.02 / 20e-3);
}

TEST(FrameRate, OfFramesOfHalfAPeriodHasHalfOfTheIdlePower) {
  const FrameRate rate = rate_of(config_with({"frame.fps=100"}), joules_of("srp", 0.01, 0), 15, 3);
  EXPECT_DOUBLE_EQ(rate.busy, 0.5);
  EXPECT_DOUBLE_EQ(rate.rate_margin(), 2);
  EXPECT_DOUBLE_EQ(rate.slack_ms(), 5);
  EXPECT_NEAR(rate.power_w.nominal, 100 * 0.01 / 3 + rate.idle_mw.nominal / 2000, 1e-12);
}

TEST(FrameRate, IsMetOnlyIfTheSlowestFrameMeetsIt) {
  const FrameRate rate = rate_of(config_with({"frame.fps=100"}), joules_of("tni", 0.01, 0), 15, 3, 11);
  EXPECT_FALSE(rate.is_met());
  EXPECT_DOUBLE_EQ(rate.rate_margin(), 10.0 / 11);
  EXPECT_DOUBLE_EQ(rate.clock_factor, 1.1);
  EXPECT_FALSE(rate.slowest.has_value());
}

TEST(IdlePower, IsLeakageAndClockByTheStateOfTheChip) {
  const RunConfig gated = config_with({}), stopped = config_with({"power.idle=clock_gated"}),
                  clocked = config_with({"power.idle=clocked"});
  const std::vector<sim::UnitReport> units = idle_unit_reports(*gated.gpu);
  const double memory = hw::dram_idle_power_mw(gated.gpu->dram).nominal;
  const auto chip_mw = [&](const RunConfig& config) { return idle_power_mw(config, units).nominal - memory; };
  const double leakage = chip_mw(stopped);
  EXPECT_NEAR(chip_mw(gated), gated.power.idle_leakage * leakage, 1e-9 * leakage);
  EXPECT_GT(chip_mw(clocked), leakage);
}

TEST(IdlePower, OfAMachineThatOnlyWaitsIsTheEnergyOfAnIdleMachine) {
  const RunConfig config = config_with({"power.idle=clocked"});
  std::vector<sim::UnitReport> units = idle_unit_reports(*config.gpu);
  std::erase_if(units, [](const sim::UnitReport& unit) { return unit.block == "dram"; });
  // Counts of one microsecond in which every unit of the chip is idle.
  for (sim::UnitReport& unit : units) {
    for (std::size_t i = 0; i < unit.cycles_by_reason.size(); ++i) {
      if (unit.reasons[i].kind != sim::ReasonKind::kIdle) continue;
      unit.cycles_by_reason[i].second = unit.clock_mhz;
      break;
    }
  }
  constexpr sim::Time kMicrosecond = sim::kFemtosecondsPerSecond / 1000000;
  const double pj = sim::compute_energy(units, config.energy, hw::dram_energy_events(config.gpu->dram), kMicrosecond,
                                        power_scales(config))
                        .total_pj.nominal;
  const double memory = hw::dram_idle_power_mw(config.gpu->dram).nominal;
  EXPECT_NEAR(idle_power_mw(config, units).nominal - memory, pj * 1e-3, 1e-6 * pj * 1e-3);
}

TEST(OperatingPoints, OfDynamicEnergyAloneAreAsSlowAsTheRateAllows) {
  const FrameRate rate = rate_of(config_with({"frame.fps=50", "power.idle_leakage=0"}), joules_of("tni", 0.01, 0), 14);
  ASSERT_TRUE(rate.best.has_value());
  EXPECT_DOUBLE_EQ(rate.slowest->factor, 0.7);
  EXPECT_DOUBLE_EQ(rate.best->factor, 0.7);
  const RunConfig config = config_with({"clocks.tni=350 MHz"});
  const double volt = voltage_needed(config, clock_domains()[0]);
  EXPECT_DOUBLE_EQ(rate.slowest->mhz[0], 350);
  EXPECT_DOUBLE_EQ(rate.slowest->volt[0], volt);
  EXPECT_NEAR(rate.slowest->power_w.nominal, 50 * 0.01 * (volt / 0.8) * (volt / 0.8), 0.2) << "and idle memory";
}

TEST(OperatingPoints, OfLeakageAtOneVoltageRaceToIdle) {
  const FrameRate rate = rate_of(config_with({"frame.fps=50", "power.idle_leakage=0", "power.leakage_exponent=0"}),
                                 joules_of("l2", 0, 0.01), 10);
  ASSERT_TRUE(rate.best.has_value());
  EXPECT_DOUBLE_EQ(rate.slowest->factor, 0.5);
  EXPECT_DOUBLE_EQ(rate.best->factor, 1);
  EXPECT_NEAR(rate.slowest->power_w.nominal, 2 * 50 * 0.01, 1e-12);
}

TEST(OperatingPoints, HaveTheLeastPowerOfAFineSearch) {
  const sim::EnergyReport energy = joules_of("tni", 0.01, 0.006);
  const FrameRate rate = rate_of(config_with({"frame.fps=60"}), energy, 6);
  ASSERT_TRUE(rate.best.has_value());
  EXPECT_GT(rate.best->factor, rate.slowest->factor);
  EXPECT_LT(rate.best->factor, 1);
  double least = 1e9;
  for (double factor = rate.slowest->factor; factor <= 1; factor += 0.005) {
    const auto clock = [&](const char* name, double hz) {
      return fmt::format("clocks.{}={:.0f} Hz", name, hz * factor);
    };
    const RunConfig config =
        config_with({clock("tni", 500e6), clock("srp", 1e9), clock("l2", 500e6), "power.voltage=dvfs"});
    const sim::PowerScale scale = power_scales(config).at("tni");
    const double ms = 6 / factor, joules = 0.01 * scale.dynamic + 0.006 * scale.leakage / factor;
    const double idle_w = idle_power_mw(config, idle_unit_reports(*config.gpu)).nominal / 1000;
    least = std::min(least, 60 * joules + idle_w * (1 - 60 * ms / 1000));
  }
  EXPECT_NEAR(rate.best->power_w.nominal, least, 0.001 * least);
}

}  // namespace
}  // namespace tools
