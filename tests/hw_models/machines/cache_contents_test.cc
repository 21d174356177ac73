#include <gtest/gtest.h>

#include "sim/engine.h"
#include "tests/hw_models/machines/gpu_harness.h"
#include "tests/hw_models/machines/random_config.h"

// Tests of machines whose caches begin with the lines that another machine left in its caches.

namespace hw {
namespace {

using test::difference;
using test::Engine;
using test::Frame;
using test::Outcome;
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
