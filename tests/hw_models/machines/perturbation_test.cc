#include <set>

#include <gtest/gtest.h>

#include "hw_models/machines/gpu.h"
#include "sim/engine.h"
#include "tests/full_size.h"
#include "tests/hw_models/machines/gpu_harness.h"
#include "tests/hw_models/machines/random_config.h"

// Tests of perturbed machines: cores start at different times, and memory is a cycle slower or faster with another
// refresh phase.

namespace hw {
namespace {

using test::difference;
using test::Engine;
using test::Frame;
using test::Outcome;

Outcome play(const Frame& frame, const GpuConfig& config, const Perturbation& perturbation,
             Engine engine = Engine::kFast, std::uint64_t seed = 0) {
  tools::FrontEnd front_end(frame.program(), frame.tracer(), 0);
  return test::play(frame, front_end, config, perturbation, engine, seed);
}

TEST(Perturbation, TheFirstReplicateHasNone) {
  const Perturbation none = random_perturbation(4, 7, 0);
  EXPECT_TRUE(none.starts.empty());
  EXPECT_EQ(none.dram.fabric, 0);
  EXPECT_EQ(none.dram.refresh, 0U);
}

TEST(Perturbation, IsSmallAndAnotherOneForEachReplicateAndFrame) {
  std::set<std::uint32_t> phases;
  std::set<std::int32_t> fabrics;
  for (std::uint32_t frame = 0; frame < 4; ++frame) {
    for (std::uint32_t replicate = 1; replicate <= 10; ++replicate) {
      const Perturbation drawn = random_perturbation(6, frame, replicate);
      ASSERT_EQ(drawn.starts.size(), 6U);
      for (const std::uint32_t start : drawn.starts) EXPECT_LT(start, 8U);
      fabrics.insert(drawn.dram.fabric);
      phases.insert(drawn.dram.refresh);
    }
  }
  EXPECT_EQ(fabrics, (std::set<std::int32_t>{-1, 0, 1}));
  EXPECT_EQ(phases.size(), 40U);
}

TEST(Perturbation, SkippingIdleTimeAndTheOrderOfUnitsStayInvisible) {
  const GpuConfig config;
  const Outcome plain = play(test::cornell_64x32(), config, {});
  for (const std::uint32_t replicate : {1U, 2U, 3U}) {
    const Perturbation drawn = random_perturbation(config.cores, 0, replicate);
    const Outcome fast = play(test::cornell_64x32(), config, drawn);
    EXPECT_NE(difference(plain, fast), "") << replicate;
    EXPECT_EQ(difference(fast, play(test::cornell_64x32(), config, drawn, Engine::kOracle)), "") << replicate;
    EXPECT_EQ(difference(fast, play(test::cornell_64x32(), config, drawn, Engine::kShuffled, replicate)), "");
  }
}

TEST(Perturbation, TheEnginesAgreeOnRandomMachinesToo) {
  static const Frame frame("cornell", 16, 16);
  for (std::uint64_t seed = 50; seed < ::test::full_or(60U, 53U); ++seed) {
    const GpuConfig config = test::random_config(seed);
    const Perturbation drawn = random_perturbation(config.cores, 0, static_cast<std::uint32_t>(seed));
    const Outcome fast = play(frame, config, drawn);
    EXPECT_EQ(difference(fast, play(frame, config, drawn, Engine::kOracle)), "") << "seed " << seed;
    EXPECT_EQ(difference(fast, play(frame, config, drawn, Engine::kShuffled, seed)), "") << "seed " << seed;
  }
}

TEST(Perturbation, ALateStartOfAllCoresDelaysTheFrameEqually) {
  GpuConfig config;
  config.cores = 1;
  config.dram.timing.refi_pb = 0;  // no other unit has a phase
  const Outcome plain = play(test::cornell_64x32(), config, {});
  const Outcome late = play(test::cornell_64x32(), config, {.starts = {5}, .dram = {}});
  const sim::Time cycle = config.clocks.l2.clock().period();
  EXPECT_EQ(late.sum("tile_dispatcher", "dispatched"), plain.sum("tile_dispatcher", "dispatched"));
  EXPECT_GE(late.elapsed + 2 * cycle, plain.elapsed + 5 * cycle);
  EXPECT_NE(difference(plain, late), "");
}

// Tests of machines whose caches begin with the lines that another machine left in its caches.

using test::run_machine;

/// Simulates the frame with these lines in the caches, and replaces `contents` by the lines at the end.
Outcome play(const Frame& frame, const GpuConfig& config, CacheContents& contents, Engine engine = Engine::kFast,
             std::uint64_t seed = 0) {
  tools::FrontEnd front_end(frame.program(), frame.tracer(), 0);
  Gpu gpu(config, frame.workload(), front_end);
  gpu.set_cache_contents(contents);
  Outcome outcome = run_machine(gpu, engine, seed);
  contents = gpu.cache_contents();
  return outcome;
}

/// Returns empty cache contents, as of a machine before its first frame.
CacheContents empty_cache_contents(const Frame& frame, const GpuConfig& config) {
  tools::FrontEnd front_end(frame.program(), frame.tracer(), 0);
  return Gpu(config, frame.workload(), front_end).cache_contents();
}

TEST(CacheContents, OfNoLinesChangeNothing) {
  const GpuConfig config;
  CacheContents contents = empty_cache_contents(test::cornell_64x32(), config);
  EXPECT_EQ(difference(test::play(test::cornell_64x32(), config), play(test::cornell_64x32(), config, contents)), "");
}

TEST(CacheContents, OfTheFrameBeforeMakeHits) {
  const GpuConfig config;
  CacheContents contents = empty_cache_contents(test::teapot_64x32(), config);
  const Outcome cold = play(test::teapot_64x32(), config, contents);
  const Outcome warm = play(test::teapot_64x32(), config, contents);
  EXPECT_LT(warm.cycles, cold.cycles);
  EXPECT_LT(warm.sum("bank", "misses"), cold.sum("bank", "misses"));
  EXPECT_EQ(warm.sum("trv", "visits"), cold.sum("trv", "visits"));
}

TEST(CacheContents, OfAFrameWhoseLinesAllFitLeaveNoMisses) {
  GpuConfig config;
  config.l2.cache.size = {4 << 20};
  CacheContents contents = empty_cache_contents(test::cornell_64x32(), config);
  play(test::cornell_64x32(), config, contents);
  EXPECT_EQ(play(test::cornell_64x32(), config, contents).sum("bank", "fills"), 0U);
}

TEST(CacheContents, AreTheSameInAllEngines) {
  static const Frame frame("cornell", 16, 16);
  for (std::uint64_t seed = 70; seed < 76; ++seed) {
    const GpuConfig config = test::random_config(seed);
    CacheContents fast = empty_cache_contents(frame, config), oracle = fast, shuffled = fast;
    for (int i = 0; i < 2; ++i) {
      const Outcome a = play(frame, config, fast);
      EXPECT_EQ(difference(a, play(frame, config, oracle, Engine::kOracle)), "") << "seed " << seed;
      EXPECT_EQ(difference(a, play(frame, config, shuffled, Engine::kShuffled, seed)), "") << "seed " << seed;
    }
  }
}

}  // namespace
}  // namespace hw
