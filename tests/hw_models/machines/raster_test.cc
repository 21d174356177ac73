#include <algorithm>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include <gtest/gtest.h>

#include "sim/config/config.h"
#include "tests/hw_models/machines/gpu_harness.h"
#include "tests/hw_models/machines/random_config.h"
#include "tests/param_name.h"
#include "traces/scenes/library.h"

// Tests of primary visibility from a rasteriser: the picture is that of rays, but the work differs.

namespace hw {
namespace {

using test::difference;
using test::Engine;
using test::Method;
using test::Outcome;
using test::play;

kernels::RenderConfig small(kernels::Primary primary, std::uint32_t width = 64, std::uint32_t height = 32) {
  kernels::RenderConfig render;
  render.width = width;
  render.height = height;
  render.tile = 16;
  render.primary = primary;
  render.raster.batch = 256;
  return render;
}

kernels::ProgramConfig programs() {
  kernels::ProgramConfig config;
  config.undersample.correction = kernels::Correction::kFour;
  config.supersample.propagate = 1;
  return config;
}

Method method(const char* scene, const char* program, kernels::Primary primary) {
  return {traces::open_scene(scene), program, programs(), small(primary)};
}

std::uint64_t primary_rays(const Outcome& run) { return run.function.rays[0]; }

bool has_unit(const Outcome& run, std::string_view kind) {
  return std::ranges::any_of(run.units, [&](const sim::UnitReport& u) { return u.path.ends_with(kind); });
}

class Rasterised : public testing::TestWithParam<const char*> {};

TEST_P(Rasterised, PictureIsThatOfRaysToTheLastBit) {
  // The scene has leaves with holes that rays pass through. Two programs only, because it is large.
  std::vector<const char*> scenes = {"cornell"};
  const std::string_view name = GetParam();
  if (name == "full:1" || name == "supersample") scenes.push_back("forest");
  for (const char* scene : scenes) {
    const traces::Scene opened = traces::open_scene(scene);
    const Method rays(opened, GetParam(), programs(), small(kernels::Primary::kRays));
    const Method raster(opened, GetParam(), programs(), small(kernels::Primary::kRaster));
    const Outcome traced = play(rays, {}), drawn = play(raster, {});
    EXPECT_EQ(traced.function.rgb, drawn.function.rgb) << scene;
    EXPECT_EQ(traced.function.sampling.traced, drawn.function.sampling.traced) << scene;
    for (std::size_t kind = 1; kind < std::size(traced.function.rays); ++kind) {
      EXPECT_EQ(traced.function.rays[kind], drawn.function.rays[kind]) << scene;
    }
    EXPECT_LE(primary_rays(drawn), drawn.function.continued) << scene << ": behind holes alone";
    EXPECT_FALSE(has_unit(traced, "raster"));
    EXPECT_TRUE(has_unit(drawn, "raster"));
  }
}

TEST_P(Rasterised, FramesAreTheSameOnAnyEngineAndNumberOfThreads) {
  const Method raster(traces::open_scene("cornell"), GetParam(), programs(), small(kernels::Primary::kRaster, 32, 16));
  GpuConfig config;
  config.cores = 2;
  const Outcome fast = play(raster, config);
  EXPECT_EQ(difference(fast, play(raster, config, Engine::kOracle)), "");
  for (const std::uint64_t seed : {std::uint64_t{1}, std::uint64_t{2}}) {
    EXPECT_EQ(difference(fast, play(raster, config, Engine::kShuffled, seed)), "") << seed;
  }
  EXPECT_EQ(difference(fast, play(raster, config, Engine::kFast, 0, 3)), "");
}
INSTANTIATE_TEST_SUITE_P(Programs, Rasterised,
                         testing::Values("full:1", "full:4", "multirate:under", "multirate:super", "undersample",
                                         "supersample", "reconstruct", "reconstruct:sraa"),
                         ::test::ParamName());

TEST(RasterisedFrame, ReadsWhatItHasWrittenAndLosesNoSample) {
  const Method raster(method("cornell", "full:1", kernels::Primary::kRaster));
  for (const bool hierarchical : {true, false}) {
    GpuConfig config;
    config.raster.hierarchical_z = hierarchical;
    const Outcome run = play(raster, config);
    const auto sum = [&](std::string_view counter) { return run.sum("raster", counter); };
    EXPECT_EQ(sum("samples_covered"), sum("samples_hidden") + sum("samples_failed") + sum("samples_passed"));
    EXPECT_EQ(sum("entries_read"), sum("entries_written")) << "each list is that of one tile";
    EXPECT_EQ(sum("entries_read"), sum("triangles_set_up"));
    EXPECT_EQ(sum("samples_out"), 64U * 32U);
    EXPECT_EQ(sum("vertices_transformed") + sum("vertices_reused"), 3 * sum("triangles"));
    EXPECT_EQ(sum("l1_hits") + sum("l1_misses"), sum("l1_accesses"));
    EXPECT_TRUE(hierarchical || sum("samples_hidden") == 0);
    EXPECT_GE(sum("samples_passed"), sum("samples_out") / 2);
    for (const sim::UnitReport& unit : run.units) {
      std::uint64_t spent = 0;
      for (const auto& [reason, cycles] : unit.cycles_by_reason) spent += cycles;
      EXPECT_EQ(spent, unit.elapsed) << unit.path;
    }
  }
}

TEST(RasterisedFrame, FinishesOnTheSmallestMachine) {
  kernels::RenderConfig render = small(kernels::Primary::kRaster, 32, 16);
  const Method raster(traces::open_scene("cornell"), "supersample", programs(), render);
  GpuConfig config;
  config.cores = 1;
  config.tile_buffer.tiles_in_flight = 1;
  config.tile_buffer.size.bytes = 1024;
  config.direct_interface.depth = config.dma.depth = config.interconnect.link_depth = 1;
  config.raster.jobs = config.raster.window = config.raster.queue = config.raster.lookups = 1;
  config.raster.l1.mshrs = config.raster.vertex_cache = 1;
  config.raster.write_buffer = 4;
  config.raster.depth_buffer.bytes = 64;
  sim::check_config(config);
  const Outcome run = play(raster, config);
  EXPECT_EQ(difference(run, play(raster, config, Engine::kShuffled, 5)), "");
  EXPECT_EQ(run.function.rgb, play(raster, {}).function.rgb);
}

TEST(RasterisedFrame, IsTheSameForAllEnginesOnRandomMachines) {
  const Method raster(traces::open_scene("cornell"), "full:1", programs(), small(kernels::Primary::kRaster, 32, 16));
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    const GpuConfig config = test::random_config(seed);
    const Outcome fast = play(raster, config);
    EXPECT_EQ(difference(fast, play(raster, config, Engine::kShuffled, seed)), "") << seed;
    EXPECT_EQ(fast.sum("raster", "entries_read"), fast.sum("raster", "entries_written")) << seed;
  }
}

TEST(RasterisedFrame, TakesLongerWithoutAHierarchicalZBufferAndWithSlowerStages) {
  const Method raster(method("cornell", "full:4", kernels::Primary::kRaster));
  GpuConfig config;
  const auto busy = [&](auto&& change) {
    GpuConfig changed = config;
    change(changed.raster);
    const Outcome run = play(raster, changed);
    std::uint64_t cycles = 0;
    for (const sim::UnitReport& unit : run.units) {
      if (!unit.path.ends_with("raster")) continue;
      for (const auto& [reason, spent] : unit.cycles_by_reason) cycles += reason == "covering" ? spent : 0;
    }
    return cycles;
  };
  const std::uint64_t usual = busy([](RasterUnitConfig&) {});
  EXPECT_GE(busy([](RasterUnitConfig& c) { c.hierarchical_z = false; }), usual);
  EXPECT_GT(busy([](RasterUnitConfig& c) { c.quad_interval = 2; }), usual);
  EXPECT_GT(busy([](RasterUnitConfig& c) { c.sub_samples = 1; }), usual);
}

}  // namespace
}  // namespace hw
