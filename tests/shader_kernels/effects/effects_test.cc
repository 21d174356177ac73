#include <cmath>
#include <string>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "shader_kernels/programs/programs.h"
#include "sim/error.h"
#include "tests/shader_kernels/harness.h"
#include "tests/shader_kernels/showcase.h"
#include "traces/accel/embree_tracer.h"

namespace kernels {
namespace {

using traces::RayKind;

constexpr auto kShadowRays = static_cast<std::size_t>(RayKind::kShadow);
constexpr auto kReflectionRays = static_cast<std::size_t>(RayKind::kReflection);
constexpr auto kRefractionRays = static_cast<std::size_t>(RayKind::kRefraction);

RenderConfig with_effects(const char* effects, std::uint32_t width = 9, std::uint32_t height = 9) {
  RenderConfig config = small(width, height);
  config.effects = effects;
  return config;
}

/// Returns a white wall in z = 0 under white ambient light, which fills the picture.
traces::Scene wall_scene() {
  traces::Scene scene = empty_scene();
  add_wall(scene, 0, 1000, {.name = "matte", .base_colour = glm::vec3(1)});
  scene.ambient = glm::vec3(1);
  return scene;
}

double mean_colour(const Picture& picture) {
  double sum = 0;
  for (const float x : picture.rgb) sum += static_cast<double>(x);
  return sum / static_cast<double>(picture.rgb.size());
}

/// A scene that can be rendered with any effects.
struct EffectStage {
  explicit EffectStage(const traces::Scene& of, const traces::BvhConfig& bvh = {})
      : scene(of), image(traces::build_memory_image(scene, bvh)), tracer(image) {}
  Picture picture(const RenderConfig& config, std::uint32_t samples = 1, bool record = false) const {
    return render(image, scene.cameras.front(), tracer, config, samples, record);
  }
  std::vector<float> by_program(const char* name, const RenderConfig& config) const {
    const ProgramConfig programs;
    const RateMap rates(programs.multirate);
    const auto program = make_program(parse_program(name), {image, scene.cameras.front(), config, programs, rates});
    run_tiles(*program, tracer, true, [](const TileResult&) {});
    return program->picture();
  }
  const traces::Scene scene;
  const traces::MemoryImage image;
  const traces::BvhTracer tracer;
};

TEST(Effects, AreNamesBetweenCommas) {
  const Effects effects = parse_effects(" occlusion,shadows ");
  EXPECT_TRUE(effects.has(Effect::kOcclusion) && effects.has(Effect::kShadows));
  EXPECT_FALSE(effects.has(Effect::kReflections) || effects.has(Effect::kSoftShadows));
  EXPECT_FALSE(parse_effects("none").has(Effect::kShadows));
}

TEST(Effects, WithUnknownNamesAreRefusedWithTheList) {
  const auto refusal = [](const char* text) -> std::string {
    try {
      parse_effects(text);
      return "";
    } catch (const sim::InputError& error) {
      return error.what();
    }
  };
  EXPECT_EQ(refusal("shadows, oclusion"),
            "'oclusion' is no effect, did you mean 'occlusion'?; allowed: none, or several of shadows, reflections, "
            "refractions, occlusion, soft_shadows, bounce between commas");
  for (const char* text : {"", ",", "shadows,", "none, shadows", "shadows occlusion"}) {
    EXPECT_NE(refusal(text).find("is no effect"), std::string::npos) << text;
  }
}

TEST(Effects, CauseAllRaysThatAreTraced) {
  const EffectStage cornell(traces::open_scene("cornell"));
  const Picture all = cornell.picture(small(64, 32));
  EXPECT_EQ(cornell.picture(with_effects("refractions, reflections, shadows", 64, 32)).rgb, all.rgb);
  EXPECT_TRUE(all.rays[kShadowRays] != 0 && all.rays[kReflectionRays] != 0 && all.rays[kRefractionRays] != 0);
  const Picture none = cornell.picture(with_effects("none", 64, 32));
  EXPECT_EQ(none.rays[0], 64U * 32U);
  EXPECT_EQ(none.rays[kShadowRays] + none.rays[kReflectionRays] + none.rays[kRefractionRays], 0U);
  const Picture mirrors = cornell.picture(with_effects("reflections", 64, 32));
  EXPECT_EQ(mirrors.rays[kShadowRays] + mirrors.rays[kRefractionRays], 0U);
  EXPECT_GT(mirrors.rays[kReflectionRays], 0U);
  const Picture glass = cornell.picture(with_effects("refractions, shadows", 64, 32));
  EXPECT_EQ(glass.rays[kReflectionRays], 0U);
  EXPECT_TRUE(glass.rays[kRefractionRays] != 0 && glass.rays[kShadowRays] != 0);
}

TEST(Effects, WithoutShadowsIgnoreOnlyOccluders) {
  traces::Scene scene = wall_scene();
  scene.ambient = glm::vec3(0.25F);
  scene.lights.push_back({.position = {0, 0, 3}, .intensity = glm::vec3(4)});
  const View free(scene, {0, 0, 2}, {0, 0, 0}, with_effects("shadows"));
  add_wall(scene, 2.5F, 1, {.name = "blind"});
  for (const Fusion fusion : {Fusion::kOn, Fusion::kOff}) {
    RenderConfig config = with_effects("none");
    config.fusion = fusion;
    EXPECT_EQ(View(scene, {0, 0, 2}, {0, 0, 0}, config).picture.rgb, free.picture.rgb);
  }
  EXPECT_LT(View(scene, {0, 0, 2}, {0, 0, 0}).centre().x, free.centre().x);
}

TEST(Occlusion, DoesNotChangeTheLightOfAnOpenSky) {
  RenderConfig config = with_effects("occlusion");
  config.occlusion_rays = 5;
  const View view(wall_scene(), {0, 0, 2}, {0, 0, 0}, config);
  for (const float x : view.picture.rgb) EXPECT_NEAR(x, 1, 1e-6F);
  EXPECT_EQ(view.picture.rays[kShadowRays], 5U * 81U);
}

TEST(Occlusion, ReachesAsFarAsConfigured) {
  traces::Scene scene = wall_scene();
  add_wall(scene, 3, 1000, {.name = "ceiling"});
  RenderConfig config = with_effects("occlusion");
  const float diagonal = traces::build_memory_image(scene).diagonal();
  config.occlusion_distance = static_cast<double>(2.9F / diagonal);
  EXPECT_NEAR(View(scene, {0, 0, 2}, {0, 0, 0}, config).centre().x, 1, 1e-6F);
  config.occlusion_distance = 1;
  EXPECT_NEAR(mean_colour(View(scene, {0, 0, 2}, {0, 0, 0}, config).picture), 0, 0.02);
}

TEST(Occlusion, AtTheFootOfAWallIsHalf) {
  traces::Scene scene = wall_scene();
  traces::add_object(scene, traces::make_quad("side", {0, -500, -1}, {0, 1000, 0}, {0, 0, 500}, 1),
                     traces::add_material(scene, {.name = "side"}));
  RenderConfig config = with_effects("occlusion", 3, 33);
  config.occlusion_rays = 16;
  config.occlusion_distance = 1;
  const View view(scene, {1, 0, 1}, {1, 0, 0}, config);
  double sum = 0;
  for (std::uint32_t y = 0; y < 33; ++y) sum += static_cast<double>(view.picture.at(1, y).x);
  EXPECT_NEAR(sum / 33, 0.5, 0.03);
}

TEST(Occlusion, RaysAreAsFrequentAsTheirCosine) {
  RenderConfig config = with_effects("occlusion", 33, 33);
  config.occlusion_rays = 4;
  const View view(wall_scene(), {0, 0, 2}, {0, 0, 0}, config);
  glm::dvec3 sum(0);
  for (const traces::Ray& ray : view.spy.seen(RayKind::kShadow)) {
    EXPECT_NEAR(glm::length(ray.direction), 1, 0.002F);
    EXPECT_GE(ray.direction.z, 0);
    sum += glm::dvec3(ray.direction);
  }
  sum /= static_cast<double>(view.spy.seen(RayKind::kShadow).size());
  EXPECT_NEAR(sum.x, 0, 0.02);
  EXPECT_NEAR(sum.y, 0, 0.02);
  EXPECT_NEAR(sum.z, 2.0 / 3, 0.01) << "mean cosine";
}

TEST(SoftShadows, OfALightWithoutARadiusAreHardOnes) {
  const EffectStage chess(traces::open_scene("chess"));
  RenderConfig config = with_effects("soft_shadows, reflections, refractions", 64, 32);
  config.light_radius = 0;
  const Picture soft = chess.picture(config), hard = chess.picture(small(64, 32));
  for (std::size_t i = 0; i < hard.rgb.size(); ++i) EXPECT_NEAR(soft.rgb[i], hard.rgb[i], 1e-5F);
  EXPECT_EQ(soft.rays[kShadowRays], 4 * hard.rays[kShadowRays]);
}

TEST(SoftShadows, RaysGoToTheLightsDiscAndEndARadiusBeforeIt) {
  traces::Scene scene = wall_scene();
  const glm::vec3 light(1, 0, 4), axis = glm::normalize(glm::vec3(0, 1, -1));
  scene.lights.push_back({.position = light, .direction = axis, .intensity = glm::vec3(4)});
  RenderConfig config = with_effects("soft_shadows", 33, 33);
  const float radius = 0.5F;
  config.light_radius = static_cast<double>(radius / traces::build_memory_image(scene).diagonal());
  const View view(scene, {0, 0, 2}, {0, 0, 0}, config);
  glm::dvec3 sum(0);
  float farthest = 0;
  for (const traces::Ray& ray : view.spy.seen(RayKind::kShadow)) {
    const glm::vec3 off = ray.origin + ray.direction - light;
    EXPECT_NEAR(glm::dot(off, axis), 0, 1e-3F);
    farthest = std::max(farthest, glm::length(off));
    sum += glm::dvec3(off);
    EXPECT_NEAR(ray.t_max, 1 - radius / glm::distance(ray.origin, light), 1e-5F);
  }
  EXPECT_EQ(view.spy.seen(RayKind::kShadow).size(), 4U * 33U * 33U);
  EXPECT_NEAR(farthest, radius, 0.01F);
  EXPECT_LT(glm::length(sum) / (4.0 * 33 * 33), 0.01);
}

TEST(SoftShadows, AreHalfLitUnderTheEdgeOfABlind) {
  traces::Scene scene = wall_scene();
  scene.ambient = glm::vec3(0);
  scene.lights.push_back({.position = {0, 0, 10}, .direction = {0, 0, -1}, .intensity = glm::vec3(50)});
  RenderConfig config = with_effects("soft_shadows", 3, 33);
  config.light_radius = static_cast<double>(1 / traces::build_memory_image(scene).diagonal());
  config.shadow_rays = 16;
  const Picture free = View(scene, {0, 0, 2}, {0, 0, 0}, config).picture;
  traces::add_object(scene, traces::make_quad("blind", {0, -500, 5}, {500, 0, 0}, {0, 1000, 0}, 1),
                     traces::add_material(scene, {.name = "blind"}));
  double sum = 0, all = 0;
  const Picture half = View(scene, {0, 0, 2}, {0, 0, 0}, config).picture;
  for (std::uint32_t y = 0; y < 33; ++y) {
    sum += static_cast<double>(half.at(1, y).x);
    all += static_cast<double>(free.at(1, y).x);
  }
  EXPECT_NEAR(sum / all, 0.5, 0.03);
}

TEST(SoftShadows, DarkenTheCornellBoxNoMoreThanHardOnes) {
  const EffectStage cornell(traces::open_scene("cornell"));
  const double hard = mean_colour(cornell.picture(small(128, 64)));
  const double soft = mean_colour(cornell.picture(with_effects("soft_shadows, reflections, refractions", 128, 64)));
  EXPECT_NEAR(soft / hard, 1, 0.02);
}

constexpr const char* kEverything = "occlusion, soft_shadows, reflections, refractions";

TEST(EffectsOfAFrame, AreTheSameInTilesOfAnySizeRecordedOrNot) {
  for (const traces::Scene& scene : {traces::open_scene("cornell"), showcase_scene()}) {
    const EffectStage stage(scene);
    for (const std::uint32_t samples : {1U, 4U}) {
      RenderConfig config = with_effects(kEverything, 67, 37);
      const Picture reference = stage.picture(config, samples);
      EXPECT_EQ(stage.picture(config, samples, true).rgb, reference.rgb);
      for (const std::uint32_t tile : {1U, 8U, 48U}) {
        config.tile = tile;
        EXPECT_EQ(stage.picture(config, samples).rgb, reference.rgb) << tile;
      }
    }
  }
}

TEST(EffectsOfAFrame, UseOtherRaysInAnotherFrame) {
  const EffectStage cornell(traces::open_scene("cornell"));
  const auto picture = [&](std::uint32_t frame) {
    FullProgram program(cornell.image, cornell.scene.cameras.front(), with_effects("occlusion", 32, 16), 1, frame);
    run_tiles(program, cornell.tracer, false, [](const TileResult&) {});
    return program.picture();
  };
  EXPECT_EQ(picture(3), picture(3));
  EXPECT_NE(picture(3), picture(4));
}

TEST(EffectsOfAFrame, UseTheSameRaysAtHitsThatEmbreeFinds) {
  const EffectStage cornell(traces::open_scene("cornell"));
  const traces::EmbreeTracer embree(cornell.image);
  const RenderConfig config = with_effects("occlusion, soft_shadows", 64, 32);
  const Picture ours = cornell.picture(config);
  const Picture truth = render(cornell.image, cornell.scene.cameras.front(), embree, config);
  std::size_t apart = 0;
  for (std::size_t i = 0; i < ours.rgb.size(); ++i) apart += std::fabs(ours.rgb[i] - truth.rgb[i]) > 0.01F ? 1 : 0;
  EXPECT_LT(apart, ours.rgb.size() / 200) << "rays that graze an edge";
}

TEST(EffectsOfAFrame, AreThoseOfUnfusedKernelsInEveryProgram) {
  traces::BvhConfig build_two_levels;
  build_two_levels.instances = traces::InstanceLevels::kTwoLevel;
  for (const traces::BvhConfig& bvh : {traces::BvhConfig{}, build_two_levels}) {
    for (const traces::Scene& scene : {traces::open_scene("cornell"), showcase_scene()}) {
      const EffectStage stage(scene, bvh);
      for (const char* effects : {"reflections", "soft_shadows, refractions", "occlusion, shadows", kEverything}) {
        for (const char* program : {"full:1", "multirate:under", "supersample", "reconstruct"}) {
          RenderConfig config = with_effects(effects, 48, 24);
          const auto fused = stage.by_program(program, config);
          config.fusion = Fusion::kOff;
          EXPECT_EQ(stage.by_program(program, config), fused) << program << ": " << effects;
          config.streams = Streams::kDivergent;
          EXPECT_EQ(stage.by_program(program, config), fused) << program << ": " << effects;
        }
      }
    }
  }
}

TEST(EffectsOfAFrame, ThatNeedRaysAreRefusedForInterpolatedSurfaces) {
  const EffectStage cornell(traces::open_scene("cornell"));
  EXPECT_NO_THROW(cornell.by_program("undersample", with_effects("none", 32, 16)));
  for (const char* effect : {"occlusion", "soft_shadows"}) {
    try {
      cornell.by_program("undersample", with_effects(effect, 32, 16));
      ADD_FAILURE() << effect;
    } catch (const sim::InputError& error) {
      EXPECT_NE(std::string(error.what()).find(std::string("render.effects: ") + effect + ": undersample"),
                std::string::npos)
          << error.what();
    }
  }
}

}  // namespace
}  // namespace kernels
