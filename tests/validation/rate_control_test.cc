#include <cmath>
#include <cstdint>
#include <filesystem>
#include <vector>

#include <gtest/gtest.h>

#include "tests/full_size.h"
#include "tests/real_scenes.h"
#include "tools/analysis/picture.h"
#include "tools/run/frame/run_job.h"
#include "traces/accel/bvh_tracer.h"

// Tests of rate control on a moving view: loss of picture quality relative to blocks of side 2 everywhere
// (DEVIATIONS.md, A6).

namespace tools {
namespace {

/// Results of `multirate:under` over several frames.
struct RateControlRun {
  explicit RateControlRun(const kernels::MultirateConfig& wanted) : config(wanted), rates(wanted) {}
  kernels::MultirateConfig config;
  kernels::RateMap rates;
  double squared_error = 0;  ///< sum over all frames
  std::uint64_t coarse = 0, tiles = 0;

  void render_frame(Inputs& inputs, const traces::Tracer& tracer, const std::vector<float>& full) {
    inputs.config.programs.multirate = config;
    const RenderResult run =
        tools::render_frame(inputs, kernels::parse_program("multirate:under"), tracer, 0, {.rates = &rates});
    squared_error += mean_squared_error(run.rgb, full);
    for (const std::uint8_t block : run.sampling.blocks) {
      coarse += block == kernels::RateMap::kCoarse ? 1 : 0;
      tiles += 1;
    }
  }
  double loss_against(const RateControlRun& other) const {
    return 10 * std::log10(squared_error / other.squared_error);
  }
};

TEST(RateControl, LosesLessThanADecibelWithAQuarterOfTheTilesCoarse) {
  const std::filesystem::path file = test::scenes_folder() / "hotel-room-animated.glb";
  if (!std::filesystem::exists(file)) GTEST_SKIP() << file << " is not here";
  const std::uint32_t frames = test::full_or(60U, 16U);
  JobOptions options;
  options.scene = file.string();
  options.resolution = "256x128";
  options.frames = "0:59";
  options.sets = {"scene.lights.rig=strongest"};
  Inputs inputs = load_inputs(options);

  kernels::MultirateConfig config = inputs.config.programs.multirate;
  RateControlRun off(config);
  config.rate_control = kernels::RateControl::kHysteresis;
  RateControlRun guarded(config);
  config.rate_texture = 2;
  RateControlRun unguarded(config);
  for (std::uint32_t frame = 0; frame < frames; ++frame) {
    if (frame != 0) {
      ASSERT_TRUE(advance_frame(inputs, 0));
    }
    const traces::BvhTracer tracer(inputs.image);
    const std::vector<float> full = render_frame(inputs, kernels::parse_program("full:1"), tracer, 0).rgb;
    for (RateControlRun* way : {&off, &guarded, &unguarded}) way->render_frame(inputs, tracer, full);
  }
  EXPECT_EQ(off.coarse, 0U);
  EXPECT_GE(guarded.coarse, guarded.tiles / 4);
  EXPECT_LE(guarded.loss_against(off), 1);
  EXPECT_LE(guarded.loss_against(off), unguarded.loss_against(off) / 4) << "textures are what it loses";
}

}  // namespace
}  // namespace tools
