#include <algorithm>
#include <cmath>
#include <memory>
#include <string>

#include <gtest/gtest.h>

#include "shader_kernels/catalogue.h"
#include "shader_kernels/programs/programs.h"
#include "sim/config/config.h"
#include "sim/error.h"
#include "tests/full_size.h"
#include "tests/shader_kernels/harness.h"
#include "tests/shader_kernels/showcase.h"

// Tests of effects at a lower rate, where some pixels trace rays and the others are filtered.

namespace kernels {
namespace {

constexpr EffectRate kLowerRates[] = {EffectRate::kHalf, EffectRate::kCheckerboard};

/// A scene that full:1 renders with effects at a given rate.
struct RatedStage {
  explicit RatedStage(const traces::Scene& of) : scene(of), image(traces::build_memory_image(scene)), tracer(image) {}
  struct Frame {
    std::vector<float> rgb;
    std::array<std::uint64_t, static_cast<std::size_t>(traces::RayKind::kCount)> rays{};
    std::uint64_t samples_out = 0, samples_in = 0;  ///< written and read samples in bytes
  };
  std::unique_ptr<FrameProgram> make(const RenderConfig& config, const char* program = "full:1") const {
    return make_program(parse_program(program), {image, scene.cameras.front(), config, programs, rates, 0, 10});
  }
  Frame render(const RenderConfig& config, bool record = false) const {
    const auto program = make(config);
    Frame frame;
    const traces::FrameRequirements needs = program->requirements();
    run_tiles(*program, tracer, record, [&](const TileResult& tile) {
      for (std::size_t k = 0; k < frame.rays.size(); ++k) frame.rays[k] += tile.rays[k];
      for (std::uint32_t n = 0; record && n < tile.work.nodes.size(); ++n) {
        const traces::WorkNode& node = tile.work.nodes[n];
        for (const traces::Edge& edge : node.inputs) EXPECT_LT(edge.node, n);
        if (node.kind != traces::WorkNode::Kind::kTransfer) continue;
        EXPECT_LE(node.offset + node.items, needs.region_bytes[static_cast<std::size_t>(node.region)]);
        if (node.region == traces::Region::kSamples)
          (node.to_memory ? frame.samples_out : frame.samples_in) += node.items;
      }
    });
    frame.rgb = program->picture();
    return frame;
  }
  const traces::Scene scene;
  const traces::MemoryImage image;
  const traces::BvhTracer tracer;
  const ProgramConfig programs{};
  const RateMap rates{programs.multirate};
};

RenderConfig rated(const char* effects, EffectRate rate, std::uint32_t width = 64, std::uint32_t height = 32) {
  RenderConfig config = small(width, height);
  config.effects = effects;
  config.effect_rate = rate;
  return config;
}

std::uint64_t shadow_rays(const RatedStage::Frame& frame) {
  return frame.rays[static_cast<std::size_t>(traces::RayKind::kShadow)];
}

/// Returns the PSNR of sRGB-encoded values with peak 1 (docs/design/methods.md).
double decibels(const std::vector<float>& a, const std::vector<float>& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    const auto code = [](float x) { return static_cast<double>(encode_srgb<float>(x)); };
    sum += (code(a[i]) - code(b[i])) * (code(a[i]) - code(b[i]));
  }
  return -10 * std::log10(sum / static_cast<double>(a.size()));
}

traces::Scene open_wall() {
  traces::Scene scene = empty_scene();
  add_wall(scene, 0, 1000, {.name = "matte", .base_colour = glm::vec3(0.5F)});
  scene.ambient = glm::vec3(1);
  scene.lights.push_back({.position = {0, 0, 30}, .direction = {0, 0, -1}, .intensity = glm::vec3(300)});
  scene.cameras.push_back(traces::look_at("front", {0, 0, 20}, {0, 0, 0}, 0.5F));
  return scene;
}

TEST(EffectRate, TakesExactlyAQuarterOrHalfOfTheRays) {
  const RatedStage wall(open_wall());
  for (const char* effects : {"occlusion", "soft_shadows", "occlusion, soft_shadows"}) {
    const std::uint64_t all = shadow_rays(wall.render(rated(effects, EffectRate::kFull)));
    for (const std::uint32_t tile : {8U, 32U}) {
      RenderConfig config = rated(effects, EffectRate::kHalf);
      config.tile = tile;
      EXPECT_EQ(4 * shadow_rays(wall.render(config, true)), all) << effects;
      config.effect_rate = EffectRate::kCheckerboard;
      EXPECT_EQ(2 * shadow_rays(wall.render(config, true)), all) << effects;
    }
  }
}

TEST(EffectRate, LeavesHardShadowsAndLaterBouncesAsTheyAre) {
  const RatedStage wall(open_wall());
  const std::uint64_t pixels = 64 * 32;
  EXPECT_EQ(shadow_rays(wall.render(rated("occlusion, shadows", EffectRate::kHalf))), pixels + 4 * pixels / 4);
  const RatedStage cornell(traces::open_scene("cornell"));
  const auto all = cornell.render(rated("occlusion, reflections, refractions", EffectRate::kFull));
  const auto half = cornell.render(rated("occlusion, reflections, refractions", EffectRate::kHalf));
  EXPECT_EQ(half.rays[2], all.rays[2]);
  EXPECT_EQ(half.rays[3], all.rays[3]);
  EXPECT_GT(4 * shadow_rays(half), shadow_rays(all));
}

TEST(EffectRate, MakesNoDifferenceWithoutOccluders) {
  const RatedStage wall(open_wall());
  for (const char* effects : {"occlusion", "occlusion, soft_shadows"}) {
    const auto all = wall.render(rated(effects, EffectRate::kFull));
    for (const EffectRate rate : kLowerRates) {
      const auto lower = wall.render(rated(effects, rate));
      for (std::size_t i = 0; i < all.rgb.size(); ++i) ASSERT_NEAR(lower.rgb[i], all.rgb[i], 1e-5F) << i;
    }
  }
}

TEST(EffectRate, GivesTheSamePictureForAnyTileSize) {
  for (const traces::Scene& scene : {traces::open_scene("cornell"), showcase_scene()}) {
    const RatedStage stage(scene);
    for (const EffectRate rate : kLowerRates) {
      RenderConfig config = rated("occlusion, soft_shadows, reflections, refractions", rate, 67, 37);
      const auto reference = stage.render(config);
      const auto recorded = stage.render(config, true);
      EXPECT_EQ(recorded.rgb, reference.rgb);
      EXPECT_EQ(recorded.rays, reference.rays);
      EXPECT_GT(recorded.samples_in, recorded.samples_out / 2);
      for (const std::uint32_t tile : {1U, 8U, 33U, 128U}) {
        config.tile = tile;
        const auto other = stage.render(config);
        EXPECT_EQ(other.rgb, reference.rgb) << tile;
        EXPECT_EQ(other.rays, reference.rays) << tile;
      }
      config.streams = Streams::kDivergent;
      config.fusion = Fusion::kOff;
      EXPECT_EQ(stage.render(config).rgb, reference.rgb);
    }
  }
}

TEST(Bounce, OfAWallUnderAWhiteSkyBringsItsAlbedo) {
  traces::Scene scene = empty_scene();
  scene.background = glm::vec3(1);
  add_wall(scene, 0, 1000, {.name = "matte", .base_colour = {0.5F, 0.25F, 0.75F}});
  scene.cameras.push_back(traces::look_at("front", {0, 0, 20}, {0, 0, 0}, 0.5F));
  const RatedStage wall(scene);
  for (const EffectRate rate : kLowerRates) {
    const auto frame = wall.render(rated("shadows, bounce", rate), true);
    for (std::size_t i = 0; i < frame.rgb.size(); ++i) {
      ASSERT_NEAR(frame.rgb[i], (std::array{0.5F, 0.25F, 0.75F}[i % 3]), 1e-5F) << i;
    }
    const std::uint64_t share = rate == EffectRate::kHalf ? 4 : 2;
    EXPECT_EQ(share * frame.rays[static_cast<std::size_t>(traces::RayKind::kReflection)], 64U * 32U);
  }
}

TEST(Bounce, GivesTheSamePictureForAnyTileSize) {
  const RatedStage stage(traces::open_scene("cornell"));
  for (const EffectRate rate : kLowerRates) {
    RenderConfig config = rated("shadows, bounce, reflections, refractions", rate, 67, 37);
    const auto reference = stage.render(config, true);
    for (const std::uint32_t tile : {8U, 33U}) {
      config.tile = tile;
      const auto other = stage.render(config);
      EXPECT_EQ(other.rgb, reference.rgb) << tile;
      EXPECT_EQ(other.rays, reference.rays) << tile;
    }
    EXPECT_NE(stage.render(rated("shadows, occlusion, reflections, refractions", rate, 67, 37)).rgb, reference.rgb);
  }
}

TEST(Bounce, NeedsALowerRateARayMoreAndNoOcclusion) {
  const auto refusal = [](RenderConfig config) -> std::string {
    try {
      sim::check_config(config);
      return "";
    } catch (const sim::InputError& error) {
      return error.what();
    }
  };
  RenderConfig config = rated("shadows, bounce", EffectRate::kHalf);
  EXPECT_EQ(refusal(config), "");
  config.depth = 1;
  EXPECT_NE(refusal(config).find("depth: is 1"), std::string::npos);
  EXPECT_NE(refusal(rated("bounce", EffectRate::kFull)).find("effect_rate: is full"), std::string::npos);
  EXPECT_NE(refusal(rated("bounce, occlusion", EffectRate::kHalf)).find("has bounce and occlusion"), std::string::npos);
}

TEST(EffectRate, IsCloseToAllRays) {
  std::vector<const char*> scenes = {"cornell"};
  if (test::is_full_size()) scenes.insert(scenes.end(), {"chess", "bathroom"});
  for (const char* scene : scenes) {
    const RatedStage stage(traces::open_scene(scene));
    constexpr const char* kEffects = "occlusion, soft_shadows, reflections, refractions";
    RenderConfig many = rated(kEffects, EffectRate::kFull, 128, 64);
    many.occlusion_rays = many.shadow_rays = 64;
    const auto truth = stage.render(many);
    const double all = decibels(stage.render(rated(kEffects, EffectRate::kFull, 128, 64)).rgb, truth.rgb);
    for (const EffectRate rate : kLowerRates) {
      const double lower = decibels(stage.render(rated(kEffects, rate, 128, 64)).rgb, truth.rgb);
      EXPECT_GT(lower, std::max(25.0, all - 10)) << scene << ": " << all << " dB with all rays";
    }
  }
}

TEST(EffectRate, AveragesVisibilityOverSimilarPixels) {
  // A row of pixels; three are finished. The middle pixel emits no rays; the left one is much farther from the eye.
  constexpr std::uint32_t kPixels = 3;
  std::vector<VisibleRecord<float>> visible(kPixels, {{0, 0, 1}, 5, 0});
  std::vector<RatioRecord<float>> ratios = {{{0.25F, 0.25F, 0.25F}, 1}, {{0, 0, 0}, 0}, {{0.75F, 0.5F, 1}, 1}};
  std::vector<ColourRecord<float>> lights(kPixels, {{1, 1, 1}}), colours(kPixels);
  const auto middle = [&] {
    UpsampleEffects<true>::Ports<float> ports;
    ports.finished = {3, 1.0F / 3, 0, 3, 0, 2, 0, 0};
    ports.visible.bind(visible.data());
    ports.ratios.bind(ratios.data());
    ports.lights.bind(lights.data());
    ports.colours.bind(colours.data());
    ports.x0 = ports.y0 = 0;
    ports.bend = 4;
    ports.apart = 0;
    colours.assign(kPixels, {{0, 0, 0}});
    for (std::uint32_t i = 0; i < kPixels; ++i) UpsampleEffects<true>::body<float>(i, ports);
    EXPECT_EQ(colours[0].rgb.x, 0.25F) << "its own";
    return glm::vec3(colours[1].rgb.x, colours[1].rgb.y, colours[1].rgb.z);
  };
  expect_near(middle(), {0.5F, 0.375F, 0.625F}, 1e-5F);
  visible[0].depth = 50;
  expect_near(middle(), {0.75F, 0.5F, 1}, 1e-3F);
  visible[2].normal = {1, 0, 0};
  expect_near(middle(), {0.5F, 0.375F, 0.625F}, 1e-3F);  // no neighbour is similar: their mean
  ratios[0].found = ratios[2].found = 0;
  expect_near({colours[0].rgb.x, 0, 0}, {0.25F, 0, 0}, 0);
}

TEST(EffectRate, AppliesOnlyToFull1AndToEffectsWithManyRays) {
  const RatedStage wall(open_wall());
  for (const char* program : {"full:4", "multirate:under", "supersample", "reconstruct"}) {
    try {
      wall.make(rated("occlusion", EffectRate::kHalf), program);
      ADD_FAILURE() << program;
    } catch (const sim::InputError& error) {
      EXPECT_NE(std::string(error.what()).find("render.effect_rate: half: the program " + std::string(program)),
                std::string::npos)
          << error.what();
    }
  }
  try {
    sim::check_config(rated("shadows", EffectRate::kCheckerboard));
    ADD_FAILURE();
  } catch (const sim::InputError& error) {
    EXPECT_NE(std::string(error.what()).find("effect_rate: is that of occlusion, soft_shadows and bounce"),
              std::string::npos)
        << error.what();
  }
}

}  // namespace
}  // namespace kernels
