#include <string>

#include <gtest/gtest.h>

#include "tests/hw_models/machines/gpu_harness.h"
#include "tests/hw_models/machines/random_config.h"
#include "tests/param_name.h"
#include "traces/scenes/library.h"

// Tests of frames with primary hits from a rasteriser, and with rays for effects beyond Whitted's.

namespace hw {
namespace {

using test::difference;
using test::Engine;
using test::Method;
using test::Outcome;
using test::play;

kernels::RenderConfig hybrid(const char* effects, std::uint32_t width = 32, std::uint32_t height = 16) {
  kernels::RenderConfig render;
  render.width = width;
  render.height = height;
  render.tile = 16;
  render.primary = kernels::Primary::kRaster;
  render.raster.batch = 256;
  render.effects = effects;
  return render;
}

class HybridFrames : public testing::TestWithParam<std::tuple<const char*, const char*>> {};

TEST_P(HybridFrames, AreTheSameOnAnyEngineAndNumberOfThreads) {
  const auto [program, effects] = GetParam();
  const Method method(traces::open_scene("cornell"), program, {}, hybrid(effects));
  GpuConfig config;
  config.cores = 2;
  const Outcome fast = play(method, config);
  EXPECT_EQ(difference(fast, play(method, config, Engine::kOracle)), "");
  EXPECT_EQ(difference(fast, play(method, config, Engine::kShuffled, 1)), "");
  EXPECT_EQ(difference(fast, play(method, config, Engine::kFast, 0, 3)), "");
  for (const sim::UnitReport& unit : fast.units) {
    std::uint64_t spent = 0;
    for (const auto& [reason, cycles] : unit.cycles_by_reason) spent += cycles;
    EXPECT_EQ(spent, unit.elapsed) << unit.path;
  }
}
INSTANTIATE_TEST_SUITE_P(Programs, HybridFrames,
                         testing::Combine(testing::Values("full:1", "multirate:under", "supersample", "reconstruct"),
                                          testing::Values("none", "occlusion, shadows",
                                                          "occlusion, soft_shadows, reflections, refractions")),
                         ::test::ParamName());

INSTANTIATE_TEST_SUITE_P(Paths, HybridFrames,
                         testing::Combine(testing::Values("path:1", "path:4"),
                                          testing::Values("shadows, reflections, refractions",
                                                          "soft_shadows, reflections, refractions")),
                         ::test::ParamName());

class RatedFrames : public testing::TestWithParam<kernels::EffectRate> {};

TEST_P(RatedFrames, AreTheSameOnAnyEngineAndNumberOfThreads) {
  kernels::RenderConfig render = hybrid("occlusion, soft_shadows, reflections", 48, 24);
  render.effect_rate = GetParam();
  render.tile = 8;  // with dependencies between tiles
  const Method method(traces::open_scene("cornell"), "full:1", {}, render);
  GpuConfig config;
  config.cores = 2;
  const Outcome fast = play(method, config);
  EXPECT_EQ(difference(fast, play(method, config, Engine::kOracle)), "");
  EXPECT_EQ(difference(fast, play(method, config, Engine::kShuffled, 1)), "");
  EXPECT_EQ(difference(fast, play(method, config, Engine::kFast, 0, 3)), "");
  config.cores = 1;
  config.tile_buffer.tiles_in_flight = 1;
  config.tile_buffer.size.bytes = 1024;
  render.primary = kernels::Primary::kRays;
  const Method by_rays(traces::open_scene("cornell"), "full:1", {}, render);
  EXPECT_EQ(play(by_rays, config).function.rgb, fast.function.rgb);
}
TEST_P(RatedFrames, WithABounceAreTheSameOnAnyEngineAndNumberOfThreads) {
  kernels::RenderConfig render = hybrid("shadows, bounce", 48, 24);
  render.effect_rate = GetParam();
  render.tile = 8;
  const Method method(traces::open_scene("cornell"), "full:1", {}, render);
  GpuConfig config;
  config.cores = 2;
  const Outcome fast = play(method, config);
  EXPECT_EQ(difference(fast, play(method, config, Engine::kOracle)), "");
  EXPECT_EQ(difference(fast, play(method, config, Engine::kShuffled, 1)), "");
  EXPECT_EQ(difference(fast, play(method, config, Engine::kFast, 0, 3)), "");
}
INSTANTIATE_TEST_SUITE_P(Rates, RatedFrames,
                         testing::Values(kernels::EffectRate::kHalf, kernels::EffectRate::kCheckerboard),
                         ::test::ParamName());

TEST(HybridFrame, OfAllEffectsFinishesOnTheSmallestMachine) {
  const Method method(traces::open_scene("cornell"), "full:1", {}, hybrid("occlusion, soft_shadows, reflections"));
  GpuConfig config;
  config.cores = 1;
  config.tile_buffer.tiles_in_flight = 1;
  config.tile_buffer.size.bytes = 1024;
  config.direct_interface.depth = config.dma.depth = config.interconnect.link_depth = 1;
  const Outcome run = play(method, config);
  EXPECT_EQ(difference(run, play(method, config, Engine::kShuffled, 5)), "");
  EXPECT_EQ(run.function.rgb, play(method, {}).function.rgb);
}

TEST(HybridFrame, OfAllEffectsIsTheSameForAllEnginesOnRandomMachines) {
  const Method method(traces::open_scene("cornell"), "full:1", {}, hybrid("occlusion, soft_shadows"));
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    const GpuConfig config = test::random_config(seed);
    const Outcome fast = play(method, config);
    EXPECT_EQ(difference(fast, play(method, config, Engine::kShuffled, seed)), "") << seed;
  }
}

}  // namespace
}  // namespace hw
