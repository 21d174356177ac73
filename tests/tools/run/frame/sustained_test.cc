#include "tools/run/frame/sustained.h"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "sim/error.h"

// Tests of sustained runs over minutes, on frames made by hand.

namespace tools {
namespace {

/// Returns a frame of 10 ms at full clock. Its energy is proportional to the square of the clock, as if voltage were
/// proportional to clock.
std::vector<SustainStep> steps(double watt, double leakage_w, std::uint32_t count = 7) {
  sim::ThermalConfig thermal;
  thermal.steps = count;
  std::vector<SustainStep> out;
  for (const double factor : governor_factors(thermal)) {
    SustainStep step;
    step.factor = factor;
    const double seconds = 0.01 / factor;
    step.frames = {{seconds, watt * 0.01 * factor * factor, leakage_w, 0.001}};
    out.push_back(step);
  }
  return out;
}

SustainSetup setup(double seconds) {
  SustainSetup s;
  s.seconds = seconds;
  s.loop = std::min(60.0, seconds);
  return s;
}

TEST(Sustain, OfACoolMachineKeepsItsFrameRate) {
  const Sustained run = sustain(steps(0.5, 0), setup(600));
  EXPECT_EQ(run.changes, 0U);
  EXPECT_NEAR(run.sustained_fps, 100, 1e-6);
  EXPECT_EQ(run.stability(), 1);
  EXPECT_EQ(run.frames, 60'000U);
  EXPECT_EQ(run.loops.size(), 10U);
}

TEST(Sustain, OfTenMinutesHasTenLoopsWhateverAFrameTakes) {
  for (const double ms : {0.4877, 3.7, 16.6}) {
    std::vector<SustainStep> one = steps(0.5, 0, 1);
    one.front().frames.front().seconds = ms / 1000;
    EXPECT_EQ(sustain(one, setup(600)).loops.size(), 10U) << ms << " ms";
  }
}

TEST(Sustain, ReachesTheSteadyTemperaturesOfItsClock) {
  SustainSetup s = setup(20'000);
  const std::vector<SustainStep> one = steps(1, 0.1, 1);
  const Sustained run = sustain(one, s);
  const auto steady = steady_temperatures(one.front(), s);
  ASSERT_TRUE(steady);
  EXPECT_NEAR(run.loops.back().temperatures.die, steady->die, 1e-3);
  EXPECT_NEAR(run.loops.back().temperatures.body, steady->body, 1e-3);
}

TEST(Sustain, EnergyIsTheSumOfItsFrames) {
  SustainSetup s = setup(60);
  const Sustained run = sustain(steps(1, 0, 1), s);
  EXPECT_NEAR(run.energy_j, static_cast<double>(run.frames) * (0.01 + 0.001), 1e-9);
  double loops = 0;
  for (const SustainLoop& loop : run.loops) loops += loop.watt * s.loop;
  EXPECT_NEAR(loops, run.energy_j, 1e-9);
}

TEST(Sustain, LeakageFollowsTheDie) {
  SustainSetup s = setup(1e4);
  s.leakage_temperature = 25;
  const Sustained cool = sustain(steps(0.5, 0.05, 1), s);
  s.thermal.ambient = 45;
  s.thermal.die_limit = s.thermal.body_limit = 150;
  const Sustained warm = sustain(steps(0.5, 0.05, 1), s);
  const auto leaks = [&](const Sustained& run) { return run.loops.back().watt - 0.5 - 0.1; };
  const double rise = warm.loops.back().temperatures.die - cool.loops.back().temperatures.die;
  EXPECT_NEAR(leaks(warm) / leaks(cool), std::exp2(rise / 25), 1e-3);
}

TEST(Sustain, OfAHotMachineEndsInABoundedCycleAtItsLimit) {
  for (const double watt : {5.0, 8.0, 12.0}) {
    SustainSetup s = setup(3600);
    const Sustained run = sustain(steps(watt, 0.2), s);
    EXPECT_GT(run.changes, 0U) << watt;
    EXPECT_LT(run.stability(), 0.95) << watt;
    EXPECT_LT(run.sustained_fps, run.first_fps) << watt;
    EXPECT_LT(run.hottest.body, s.thermal.body_limit + 0.1) << watt;
    // In the second half hour the body temperatures of all loops are close together, just below the limit.
    const auto later = std::ranges::subrange(run.loops.begin() + 30, run.loops.end());
    const auto [coolest, hottest] =
        std::ranges::minmax(later, {}, [](const SustainLoop& l) { return l.temperatures.body; });
    EXPECT_LT(hottest.temperatures.body - coolest.temperatures.body, 0.5) << watt;
    EXPECT_GT(coolest.temperatures.body, s.thermal.body_limit - 1) << watt;
  }
}

TEST(Sustain, TakesAClockBetweenTheStepsWhoseSteadyTemperaturesEncloseTheLimit) {
  SustainSetup s = setup(7200);
  const std::vector<SustainStep> all = steps(8, 0.2);
  const Sustained run = sustain(all, s);
  double within = 0, beyond = 1;
  for (const SustainStep& step : all) {
    const auto steady = steady_temperatures(step, s);
    const bool is_cool = steady && steady->body <= s.thermal.body_limit && steady->die <= s.thermal.die_limit;
    (is_cool ? within : beyond) = is_cool ? std::max(within, step.factor) : std::min(beyond, step.factor);
  }
  EXPECT_GE(run.loops.back().factor, within - 0.1);
  EXPECT_LE(run.loops.back().factor, beyond);
}

TEST(Sustain, WarnsIfTheSlowestClocksAreTooHot) {
  EXPECT_TRUE(limit_warnings(steps(8, 0.2), setup(600)).empty());
  const std::vector<std::string> hot = limit_warnings(steps(80, 0.2), setup(600));
  ASSERT_EQ(hot.size(), 1U);
  EXPECT_NE(hot.front().find("the slowest clocks (x 0.4) end at"), std::string::npos) << hot.front();
  const std::vector<std::string> leaking = limit_warnings(steps(1, 20), setup(600));
  ASSERT_EQ(leaking.size(), 1U);
  EXPECT_NE(leaking.front().find("let leakage run away"), std::string::npos) << leaking.front();
}

TEST(Sustain, AtAFrameRateTheRestOfThePeriodIsIdle) {
  SustainSetup s = setup(60);
  s.fps = 30;
  s.idle_memory_w = 0.01;
  const Sustained run = sustain(steps(1, 0, 1), s);
  EXPECT_NEAR(run.sustained_fps, 30, 0.1);
  EXPECT_NEAR(run.energy_j, static_cast<double>(run.frames) * (0.011 + 0.01 * (1.0 / 30 - 0.01)), 1e-6);
}

TEST(Sustain, HasExactlyTheTargetRateIfEveryFrameFitsItsPeriod) {
  for (const double fps : {29.97, 30.0, 59.94, 60.0, 90.0, 100.0}) {
    SustainSetup s = setup(600);
    s.fps = fps;
    std::vector<SustainStep> one = steps(0.5, 0, 1);
    for (const double seconds : {0.0001, 0.01, 1 / fps}) {
      one.front().frames.front().seconds = seconds;
      if (fps * seconds > 1) continue;
      const Sustained run = sustain(one, s);
      EXPECT_EQ(run.sustained_fps, fps) << seconds;
      EXPECT_EQ(run.first_fps, fps) << seconds;
      EXPECT_EQ(run.stability(), 1) << seconds;
    }
    one.front().frames.push_back(one.front().frames.front());
    one.front().frames.back().seconds = 1.01 / fps;
    EXPECT_LT(sustain(one, s).sustained_fps, fps) << "every second frame is late";
  }
}

TEST(Sustain, CountsPeriodsWhenItRefusesALongRun) {
  SustainSetup s = setup(1.2e7);
  std::vector<SustainStep> one = steps(0.001, 0, 1);
  one.front().frames.front().seconds = 1e-3;
  EXPECT_THROW(sustain(one, s), sim::InputError) << "12,000,000,000 frames";
  s.fps = 0.01;
  EXPECT_EQ(sustain(one, s).frames, 120'000U);
}

TEST(Sustain, OfAConfigurationWithAFrameRateHeatsByItsMeanPower) {
  JobOptions job;
  job.sets = {"thermal.minutes=1", "frame.fps=30"};
  SustainSetup limited = sustain_setup(load_run_config(job));
  EXPECT_EQ(limited.fps, 30);
  limited.seconds = 20'000;
  limited.idle_memory_w = 0;
  SustainSetup averaged = limited;
  averaged.fps = 0;
  // A frame of 10 ms in a period of 33 ms heats like a machine that always takes 30 % of its power.
  const Sustained run = sustain(steps(3, 0, 1), limited);
  std::vector<SustainStep> spread = steps(3, 0, 1);
  spread.front().frames.front().seconds = 1.0 / 30;
  const Sustained mean = sustain(spread, averaged);
  EXPECT_NEAR(run.sustained_fps, 30, 0.1);
  EXPECT_NEAR(run.loops.back().temperatures.body, mean.loops.back().temperatures.body, 0.01);
  EXPECT_NEAR(run.loops.back().watt, mean.loops.back().watt, 0.01);
  averaged.seconds = 600;
  EXPECT_GT(sustain(steps(3, 0, 1), averaged).hottest.body, run.hottest.body) << "without a rate it never idles";
}

TEST(Sustain, AClockedChipTakesItsClockInTheRestOfThePeriod) {
  SustainSetup s = setup(60);
  s.fps = 30;
  std::vector<SustainStep> one = steps(1, 0, 1);
  const Sustained gated = sustain(one, s);
  one.front().frames.front().idle_clock_w = 0.3;
  const Sustained clocked = sustain(one, s);
  const double idle_seconds = static_cast<double>(clocked.frames) * (1.0 / 30 - 0.01);
  EXPECT_NEAR(clocked.energy_j - gated.energy_j, 0.3 * idle_seconds, 1e-6);
  s.seconds = 20'000;
  s.loop = 60;
  EXPECT_NEAR(sustain(one, s).loops.back().temperatures.die, steady_temperatures(one.front(), s)->die, 1e-2);
}

TEST(Sustain, SequencesRepeatTheirFrames) {
  std::vector<SustainStep> two = steps(1, 0, 1);
  two.front().frames.push_back({0.03, 0.002, 0, 0});
  const Sustained run = sustain(two, setup(40));
  EXPECT_EQ(run.frames, 2000U);
  EXPECT_NEAR(run.energy_j, 1000 * (0.011 + 0.002), 1e-6);
}

TEST(ThermalGovernor, StepsDownAboveTheDiesLimitUnlessItCoolsAndUpBelowBoth) {
  sim::ThermalConfig config;
  config.die_limit = 90, config.body_limit = 40, config.hysteresis = 1, config.lookahead = 10;
  ThermalGovernor governor(config, 3);
  governor.choose_next_clock({50, 30}, 1);
  governor.choose_next_clock({50, 30}, 1);
  EXPECT_FALSE(governor.choose_next_clock({50, 30}, 1)) << "the fastest already";
  EXPECT_TRUE(governor.choose_next_clock({91, 30}, 1));
  EXPECT_TRUE(governor.choose_next_clock({91, 30}, 1)) << "not cooler yet";
  EXPECT_EQ(governor.clock_step(), 2U);
  EXPECT_FALSE(governor.choose_next_clock({92, 30}, 1)) << "the slowest already";
  EXPECT_FALSE(governor.choose_next_clock({90.5, 30}, 1)) << "cooling";
  EXPECT_FALSE(governor.choose_next_clock({89.5, 30}, 1)) << "within the hysteresis";
  EXPECT_TRUE(governor.choose_next_clock({88, 30}, 1));
}

TEST(ThermalGovernor, StepsDownBeforeTheBodyPassesItsLimit) {
  sim::ThermalConfig config;
  config.die_limit = 90, config.body_limit = 40, config.hysteresis = 1, config.lookahead = 10;
  ThermalGovernor governor(config, 3);
  governor.choose_next_clock({50, 35}, 1);
  governor.choose_next_clock({50, 35}, 1);
  EXPECT_FALSE(governor.choose_next_clock({50, 35.3}, 1)) << "38.3 in ten seconds";
  EXPECT_TRUE(governor.choose_next_clock({50, 36}, 1)) << "43 in ten seconds";
  EXPECT_FALSE(governor.choose_next_clock({50, 36.3}, 1)) << "39.3: within the hysteresis";
  EXPECT_TRUE(governor.choose_next_clock({50, 36.4}, 1)) << "37.4";
}

TEST(ThermalGovernor, ExtrapolatesTheBodyAtItsRateSinceTheLastDecision) {
  sim::ThermalConfig config;
  config.die_limit = 90, config.body_limit = 40, config.hysteresis = 1, config.lookahead = 10;
  for (const double seconds : {1.0, 10.0}) {
    ThermalGovernor governor(config, 3);
    governor.choose_next_clock({50, 35}, 1);
    governor.choose_next_clock({50, 35}, 1);
    EXPECT_EQ(governor.choose_next_clock({50, 36}, seconds), seconds == 1) << "46 or 37 in ten seconds";
  }
}

TEST(GovernorFactors, AreEvenlySpacedFromTheConfiguredClock) {
  sim::ThermalConfig config;
  config.steps = 4, config.slowest = 0.4;
  const std::vector<double> factors = governor_factors(config);
  ASSERT_EQ(factors.size(), 4U);
  for (std::size_t i = 0; i < factors.size(); ++i) EXPECT_NEAR(factors[i], 1 - 0.2 * static_cast<double>(i), 1e-12);
  config.steps = 1;
  EXPECT_EQ(governor_factors(config), std::vector<double>{1});
}

}  // namespace
}  // namespace tools
