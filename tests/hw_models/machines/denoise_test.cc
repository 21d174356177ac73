#include <string>

#include <gtest/gtest.h>

#include "tests/hw_models/machines/gpu_harness.h"
#include "traces/scenes/library.h"

// Tests of the denoiser's passes on whole machines.

namespace hw {
namespace {

using test::difference;
using test::Engine;
using test::Method;
using test::Outcome;
using test::play;

kernels::ProgramConfig with_iterations(std::uint32_t iterations) {
  kernels::ProgramConfig config;
  config.denoise.filter = kernels::DenoiseFilter::kAtrous;
  config.denoise.iterations = iterations;
  return config;
}

TEST(Denoise, AllEnginesAndThreadsAgree) {
  const Method method{"cornell", "full:1", with_iterations(5), 12, 9, 4};
  const GpuConfig config;
  const Outcome fast = play(method, config);
  EXPECT_EQ(difference(fast, play(method, config, Engine::kOracle)), "");
  EXPECT_EQ(difference(fast, play(method, config, Engine::kShuffled, 1)), "");
  const Outcome threads = play(method, config, Engine::kFast, 0, 2);
  EXPECT_EQ(difference(fast, threads), "");
  EXPECT_EQ(difference(fast.function, threads.function), "");
}

TEST(Denoise, OfEffectsAtALowerRateAllEnginesAndThreadsAgree) {
  kernels::RenderConfig render;
  render.width = 20;
  render.height = 13;
  render.tile = 8;
  render.depth = 2;
  render.primary = kernels::Primary::kRaster;
  render.effects = "shadows, bounce";
  render.effect_rate = kernels::EffectRate::kHalf;
  const Method method(traces::open_scene("cornell"), "full:1", with_iterations(4), render);
  GpuConfig config;
  config.cores = 2;
  const Outcome fast = play(method, config);
  EXPECT_EQ(difference(fast, play(method, config, Engine::kOracle)), "");
  EXPECT_EQ(difference(fast, play(method, config, Engine::kShuffled, 1)), "");
  const Outcome threads = play(method, config, Engine::kFast, 0, 3);
  EXPECT_EQ(difference(fast, threads), "");
  EXPECT_EQ(difference(fast.function, threads.function), "");
}

TEST(Denoise, TrafficIsThatOfItsTransfersAndLoads) {
  // One tile of 16 x 16 pixels: every row of an array is whole lines.
  const GpuConfig config;
  const auto lines = [&](std::uint32_t iterations, const char* counter) {
    const Method method{"cornell", "full:1", with_iterations(iterations), 16, 16, 16};
    return play(method, config).sum("dma", counter);
  };
  constexpr std::uint64_t kPixels = 256, kLine = 64;
  // Block 24, light 8, guides 8, moments 4 bytes a pixel.
  EXPECT_EQ(lines(0, "samples_lines_written"), kPixels * (24 + 20) / kLine);
  EXPECT_EQ(lines(0, "samples_lines_read"), kPixels * (20 + 8 + 4) / kLine);
  // An iteration reads light and guides of the tile, whose halo is outside the picture, and writes light.
  EXPECT_EQ(lines(3, "samples_lines_written"), kPixels * (24 + 20 + 3 * 8) / kLine);
  EXPECT_EQ(lines(3, "samples_lines_read"), kPixels * (20 + 3 * 16 + 8 + 4) / kLine);
  // Iterations 4 and 5 read through the data cache.
  EXPECT_EQ(lines(5, "samples_lines_written"), kPixels * (24 + 20 + 5 * 8) / kLine);
  EXPECT_EQ(lines(5, "samples_lines_read"), kPixels * (20 + 3 * 16 + 8 + 4) / kLine);
}

}  // namespace
}  // namespace hw
