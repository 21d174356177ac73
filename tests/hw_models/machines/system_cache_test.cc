#include <algorithm>

#include <gtest/gtest.h>

#include "sim/config/config.h"
#include "sim/error.h"
#include "tests/hw_models/machines/gpu_harness.h"

// Tests of the system cache in front of the DRAM channels, and of other traffic of the chip on these channels.

namespace hw {
namespace {

using test::difference;
using test::Engine;
using test::Frame;
using test::Outcome;
using test::play;

GpuConfig with_cache(std::uint64_t bytes) {
  GpuConfig c;
  c.l2.cache.size = {16 * 1024};
  c.slc.cache.size = {bytes};
  return c;
}

GpuConfig with_traffic(double rate, BackgroundPattern pattern = BackgroundPattern::kSequential) {
  GpuConfig c;
  c.background.rate = rate;
  c.background.pattern = pattern;
  return c;
}

double microseconds(const Outcome& run) { return static_cast<double>(run.elapsed) * 1e-9; }

TEST(SystemCache, AnswersTheL2AndTheDmaAndReadsTheRestFromTheChannels) {
  const Outcome run = play(test::teapot_64x32(), with_cache(64 * 1024));
  EXPECT_EQ(run.sum("slice", "reads"), run.sum("bank", "fills") + run.sum("dma", "lines_read"));
  EXPECT_EQ(run.sum("slice", "writes"),
            run.sum("dma", "lines_written") + run.sum("bank", "written_back") + run.sum("bank", "passed_on"));
  EXPECT_EQ(run.sum("slice", "hits") + run.sum("slice", "misses"), run.sum("slice", "reads"));
  EXPECT_EQ(run.sum("slice", "fills") + run.sum("slice", "merges"), run.sum("slice", "misses"));
  EXPECT_EQ(run.sum("channel", "reads"), run.sum("slice", "fills"));
  EXPECT_EQ(run.sum("channel", "writes"), run.sum("slice", "written_back"));
  EXPECT_GT(run.sum("slice", "hits"), 0U);
}

TEST(SystemCache, SavesMoreReadsOfMemoryIfItIsLarger) {
  const Outcome none = play(test::teapot_64x32(), with_cache(0));
  std::uint64_t before = none.sum("channel", "reads");
  EXPECT_ANY_THROW(none.sum("slice", "reads")) << "there are no slices";
  for (const std::uint64_t kib : {64U, 256U, 4096U}) {
    const Outcome run = play(test::teapot_64x32(), with_cache(kib * 1024));
    EXPECT_LT(run.sum("channel", "reads"), before) << kib << " KiB";
    EXPECT_EQ(difference(run.function, none.function), "") << "the picture";
    before = run.sum("channel", "reads");
  }
}

TEST(SystemCache, OfNoSizeHasNoEffect) {
  const GpuConfig plain;
  GpuConfig shaped;
  shaped.slc.cache.ways = 4;
  shaped.slc.lookup_cycles = 60;
  EXPECT_EQ(difference(play(test::cornell_64x32(), plain), play(test::cornell_64x32(), shaped)), "");
}

TEST(SystemCache, OfAShapeThatDoesNotFitTheChannelsIsRefused) {
  GpuConfig c = with_cache(1 << 20);
  c.slc.cache.mshrs = 2;
  EXPECT_THROW(sim::check_config(c), sim::InputError);
  c = with_cache(3000);
  EXPECT_THROW(sim::check_config(c), sim::InputError);
  EXPECT_NO_THROW(sim::check_config(with_cache(1 << 20)));
}

TEST(Background, SendsItsRateWhileTheFrameRuns) {
  for (const BackgroundPattern pattern : {BackgroundPattern::kSequential, BackgroundPattern::kRandom}) {
    const GpuConfig config = with_traffic(4, pattern);
    const Outcome run = play(test::cornell_64x32(), config);
    const double lines = static_cast<double>(run.sum("source", "reads") + run.sum("source", "writes"));
    EXPECT_NEAR(lines, 4e3 * microseconds(run) / 64, 0.01 * lines + 4);
    EXPECT_NEAR(static_cast<double>(run.sum("source", "writes")) / lines, config.background.writes, 0.03);
    EXPECT_EQ(run.sum("channel", "reads"),
              run.sum("source", "reads") + run.sum("bank", "fills") + run.sum("dma", "lines_read"));
  }
}

TEST(Background, SlowsTheFrameMoreAtAHigherRateAndChangesNoPicture) {
  const Outcome alone = play(test::teapot_64x32(), GpuConfig{});
  std::uint64_t before = alone.cycles;
  for (const double rate : {8.0, 20.0}) {
    const Outcome run = play(test::teapot_64x32(), with_traffic(rate, BackgroundPattern::kRandom));
    EXPECT_GT(run.cycles, before) << rate;
    EXPECT_EQ(difference(run.function, alone.function), "");
    before = run.cycles;
  }
}

TEST(Background, OfMoreThanTheMemoryCanMoveStillLetsTheFrameEnd) {
  const Outcome run = play(test::cornell_64x32(), with_traffic(1000));
  EXPECT_GT(run.sum("source", "reads"), 0U);
  const double moved = static_cast<double>(run.sum("channel", "bytes")) / microseconds(run) / 1e3;
  EXPECT_LT(moved, 25.7) << "GB/s, the peak of four channels";
}

TEST(Background, TakesOneOfTheRequestersOfAChannel) {
  GpuConfig c;
  c.l2.banks = 32;
  c.l2.cache.mshrs = 32;
  c.cores = 32;
  EXPECT_NO_THROW(sim::check_config(c));
  c.background.rate = 1;
  EXPECT_THROW(sim::check_config(c), sim::InputError);
}

TEST(SystemCacheAndBackground, AreTheSameInEveryEngine) {
  static const Frame frame("cornell", 16, 16);
  for (const std::uint64_t kib : {0U, 16U, 1024U}) {
    for (const double rate : {0.0, 3.0, 40.0}) {
      GpuConfig config = with_cache(kib * 1024);
      config.background.rate = rate;
      config.background.pattern = kib == 16 ? BackgroundPattern::kRandom : BackgroundPattern::kSequential;
      config.direct_interface.enabled = kib != 16;  // rays then go through memory, which causes writes
      const Outcome fast = play(frame, config);
      EXPECT_EQ(difference(fast, play(frame, config, Engine::kOracle)), "") << kib << " KiB, " << rate << " GB/s";
      for (const std::uint64_t seed : {1U, 2U}) {
        EXPECT_EQ(difference(fast, play(frame, config, Engine::kShuffled, seed)), "") << kib << " " << rate;
      }
    }
  }
}

}  // namespace
}  // namespace hw
