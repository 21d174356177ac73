#include <gtest/gtest.h>

#include "tests/full_size.h"
#include "tests/hw_models/machines/gpu_harness.h"
#include "tests/hw_models/machines/random_config.h"

namespace hw {
namespace {

using test::difference;
using test::Engine;
using test::Frame;
using test::Outcome;
using test::play;

TEST(Gpu, SkippingIdleTimeGivesTheOraclesCounters) {
  const GpuConfig config;
  const Outcome fast = play(test::cornell_64x32(), config);
  EXPECT_EQ(difference(fast, play(test::cornell_64x32(), config, Engine::kOracle)), "");
}

TEST(Gpu, TheOrderOfUnitsWithinAStepIsInvisible) {
  const GpuConfig config;
  const Outcome fast = play(test::cornell_64x32(), config);
  for (const std::uint64_t seed : {1U, 2U, 3U}) {
    EXPECT_EQ(difference(fast, play(test::cornell_64x32(), config, Engine::kShuffled, seed)), "") << seed;
  }
}

TEST(Gpu, TheOracleAgreesOnRandomMachinesToo) {
  static const Frame frame("cornell", 16, 16);
  for (std::uint64_t seed = 0; seed < ::test::full_or(16U, 6U); ++seed) {
    const GpuConfig config = test::random_config(seed);
    EXPECT_EQ(difference(play(frame, config), play(frame, config, Engine::kOracle)), "") << "seed " << seed;
  }
}

TEST(Gpu, TheOrderOfUnitsIsInvisibleOnRandomMachinesToo) {
  static const Frame frame("cornell", 32, 16);
  for (std::uint64_t seed = 16; seed < ::test::full_or(40U, 24U); ++seed) {
    const GpuConfig config = test::random_config(seed);
    EXPECT_EQ(difference(play(frame, config), play(frame, config, Engine::kShuffled, seed)), "") << "seed " << seed;
  }
}

TEST(Gpu, TheOracleAgreesOnScenesOfInstancesInAnyOrderOfUnits) {
  const traces::BvhConfig levels{.instances = traces::InstanceLevels::kTwoLevel};
  static const Frame frame("chess", 16, 16, 1, 16, levels);
  for (std::uint64_t seed = 40; seed < ::test::full_or(45U, 42U); ++seed) {
    const GpuConfig config = test::random_config(seed);
    const Outcome fast = play(frame, config);
    EXPECT_GT(fast.sum("trv", "transforms"), 0U);
    EXPECT_EQ(difference(fast, play(frame, config, Engine::kOracle)), "") << "seed " << seed;
    EXPECT_EQ(difference(fast, play(frame, config, Engine::kShuffled, seed)), "") << "seed " << seed;
  }
}

TEST(Gpu, ThreadsThatRunAheadOfTheMachineChangeNothing) {
  const GpuConfig config;
  const Outcome alone = play(test::teapot_64x32(), config);
  for (const std::uint32_t workers : {1U, 2U}) {
    const Outcome run = play(test::teapot_64x32(), config, Engine::kFast, 0, workers);
    EXPECT_EQ(difference(alone, run), "") << workers;
    EXPECT_EQ(difference(alone.function, run.function), "") << workers;
  }
}

}  // namespace
}  // namespace hw
