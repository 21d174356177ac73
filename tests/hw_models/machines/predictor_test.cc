#include <gtest/gtest.h>

#include "tests/hw_models/machines/gpu_harness.h"
#include "traces/scenes/library.h"

// Tests of frames whose any-hit rays are predicted.

namespace hw {
namespace {

using test::difference;
using test::Engine;
using test::Method;
using test::Outcome;
using test::play;

kernels::RenderConfig with_occlusion() {
  kernels::RenderConfig render;
  render.width = 32;
  render.height = 16;
  render.tile = 8;
  render.effects = "occlusion, shadows, reflections, refractions";
  render.occlusion_distance = 0.5;
  render.occlusion_rays = 1;
  return render;
}

constexpr traces::PredictorConfig kLearning{.enabled = true, .origin_bits = 2, .go_up = 6, .lag = 2, .ray_lag = 8};

GpuConfig machine(bool predicts) {
  GpuConfig config;
  config.cores = 2;
  if (predicts) config.tni.predictor = kLearning;
  return config;
}

TEST(PredictedFrames, AreTheSameOnAnyEngineAndNumberOfThreads) {
  for (const char* program : {"full:1", "multirate:under"}) {
    SCOPED_TRACE(program);
    const Method method(traces::open_scene("cornell"), program, {}, with_occlusion(), {}, kLearning);
    const Outcome fast = play(method, machine(true));
    EXPECT_EQ(difference(fast, play(method, machine(true), Engine::kOracle)), "");
    EXPECT_EQ(difference(fast, play(method, machine(true), Engine::kShuffled, 1)), "");
    EXPECT_EQ(difference(fast, play(method, machine(true), Engine::kFast, 0, 3)), "");
    EXPECT_GT(fast.sum("predictor", "correct"), 0U);
    EXPECT_GT(fast.sum("predictor", "wrong"), 0U);
    for (const sim::UnitReport& unit : fast.units) {
      std::uint64_t spent = 0;
      for (const auto& [reason, cycles] : unit.cycles_by_reason) spent += cycles;
      EXPECT_EQ(spent, unit.elapsed) << unit.path;
    }
  }
}

TEST(PredictedFrames, HaveThePicturesOfOtherFrames) {
  traces::Scene veiled = traces::open_scene("cornell");
  for (std::size_t m = 0; m < veiled.materials.size(); m += 3) {
    veiled.materials[m].alpha = traces::Material::Alpha::kBlend;
    veiled.materials[m].opacity = 0.5F;
  }
  const traces::Scene scenes[] = {traces::open_scene("cornell"), traces::open_scene("teapot"), veiled};
  for (const traces::Scene& scene : scenes) {
    for (const std::uint32_t width : {2U, 4U}) {
      const traces::BvhConfig bvh{.width = width};
      const Outcome with = play(Method(scene, "full:1", {}, with_occlusion(), bvh, kLearning), machine(true));
      const Outcome without = play(Method(scene, "full:1", {}, with_occlusion(), bvh), machine(false));
      EXPECT_EQ(with.function.rgb, without.function.rgb);
      EXPECT_GT(with.sum("predictor", "correct"), 0U);
      const auto shadow = static_cast<std::size_t>(traces::RayKind::kShadow);
      EXPECT_EQ(with.sum("predictor", "look_ups"), with.function.rays[shadow]) << "layers included";
      EXPECT_EQ(with.sum("predictor", "rays"), with.rays());
      EXPECT_EQ(with.sum("predictor", "predicted"), with.sum("predictor", "correct") + with.sum("predictor", "wrong"));
    }
  }
}

TEST(PredictedFrames, LearnNothingBeforeTheLags) {
  traces::PredictorConfig late = kLearning;
  late.lag = 64;  // more than all tiles
  late.ray_lag = 65536;
  const Method method(traces::open_scene("cornell"), "full:1", {}, with_occlusion(), {}, late);
  const Outcome outcome = play(method, machine(true));
  EXPECT_EQ(outcome.sum("predictor", "predicted"), 0U);
  EXPECT_GT(outcome.sum("predictor", "updates"), 0U);
  const Method plain(traces::open_scene("cornell"), "full:1", {}, with_occlusion());
  EXPECT_EQ(outcome.function.traversal_steps, play(plain, machine(false)).function.traversal_steps);
}

}  // namespace
}  // namespace hw
