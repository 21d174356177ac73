#include <gtest/gtest.h>

#include "hw_models/srp/data_cache.h"
#include "tests/hw_models/machines/conservation.h"
#include "tests/hw_models/machines/gpu_harness.h"
#include "tests/hw_models/machines/random_config.h"
#include "tests/shader_kernels/showcase.h"
#include "traces/scenes/library.h"

// Tests of scenes with all material features on whole machines: rays that continue through surfaces, several kinds of
// records and textures.

namespace hw {
namespace {

using test::difference;
using test::Engine;
using test::Frame;
using test::Outcome;
using test::play;

TEST(GpuDetails, EveryRayThatContinuesIsTraced) {
  static const Frame frame(kernels::showcase_scene(), 64, 32);
  const GpuConfig config;
  const Outcome run = play(frame, config);
  test::expect_conserved(run, frame, config);
  EXPECT_GT(run.function.continued, 500U);
  EXPECT_GT(run.function.rays[0], 64U * 32U);
}

TEST(GpuDetails, OracleOrderAndThreadsChangeNothing) {
  static const Frame frame(kernels::showcase_scene(), 32, 32);
  const GpuConfig config;
  const Outcome fast = play(frame, config);
  EXPECT_EQ(difference(fast, play(frame, config, Engine::kOracle)), "");
  EXPECT_EQ(difference(fast, play(frame, config, Engine::kShuffled, 7)), "");
  const Outcome ahead = play(frame, config, Engine::kFast, 0, 2);
  EXPECT_EQ(difference(fast, ahead), "");
  EXPECT_EQ(difference(fast.function, ahead.function), "");
}

TEST(GpuDetails, SmallAndOddMachinesFinishAndAgreeWithTheOracle) {
  static const Frame frame(kernels::showcase_scene(), 32, 16);
  for (std::uint64_t seed = 100; seed < 106; ++seed) {
    const GpuConfig config = test::random_config(seed);
    const Outcome run = play(frame, config);
    test::expect_conserved(run, frame, config);
    EXPECT_EQ(difference(run, play(frame, config, Engine::kOracle)), "") << "seed " << seed;
  }
  GpuConfig tiny;
  tiny.tile_buffer.size.bytes = 1024;
  tiny.tile_buffer.tiles_in_flight = 1;
  test::expect_conserved(play(frame, tiny), frame, tiny);
}

TEST(GpuDetails, MipLevelsAndEncodedPixelsAreTheSameForAllEngines) {
  kernels::RenderConfig render;
  render.width = 32;
  render.height = 16;
  render.srgb = kernels::SrgbEncoder::kDma;
  for (const kernels::MipBlend blend : {kernels::MipBlend::kNearest, kernels::MipBlend::kLinear}) {
    render.mip_filter = blend;
    const test::Method method(kernels::showcase_scene(), "full:1", {}, render);
    for (const GpuConfig& config : {GpuConfig{}, test::random_config(107), test::random_config(108)}) {
      const Outcome fast = play(method, config);
      EXPECT_EQ(difference(fast, play(method, config, Engine::kOracle)), "");
      EXPECT_EQ(difference(fast, play(method, config, Engine::kShuffled, 7)), "");
      EXPECT_EQ(fast.sum("dma", "pixels_encoded"), 32U * 16U);
    }
  }
}

TEST(GpuDetails, MipMapsSpareTheDataCacheMisses) {
  kernels::RenderConfig render;
  render.width = 64;
  render.height = 32;
  const auto misses = [&](traces::MipMaps mip_maps) {
    render.mip_maps = mip_maps;
    return play(test::Method(traces::open_scene("teapot"), "full:1", {}, render), {}).sum("srp", "cache_misses");
  };
  EXPECT_LT(2 * misses(traces::MipMaps::kOn), misses(traces::MipMaps::kOff));
}

TEST(GpuDetails, RecordsOfAllKindsAreReadAtTheirAddresses) {
  traces::Layout layout;
  layout.vertices = 1 << 12;
  layout.details = 1 << 13;
  using Kind = traces::Access::Kind;
  const LineSet vertices = lines_of_access(traces::Access::of_kind(Kind::kVertices, 3), layout);
  ASSERT_EQ(vertices.count, 1U);
  EXPECT_EQ(vertices.line[0], (1U << 12) + 3 * 64);
  const LineSet detail = lines_of_access(traces::Access::of_kind(Kind::kDetail, 2), layout);
  ASSERT_EQ(detail.count, 1U);
  EXPECT_EQ(detail.line[0], (1U << 13) + 2 * 64);
}

}  // namespace
}  // namespace hw
