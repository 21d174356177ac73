#include <algorithm>
#include <cmath>
#include <numeric>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "block_harness.h"
#include "shader_kernels/kernels/arithmetic.h"
#include "shader_kernels/kernels/record_hits.h"
#include "showcase.h"
#include "sim/hash.h"

// Tests of similarity checks: each fails exactly where its attribute differs.

namespace kernels {
namespace {

TEST(Sampling, AFlatWallIsTracedOnlyAtReferencesAndThePicturesEdge) {
  const Stage stage = Room().add(sheet(-10, 10)).stage();
  for (const auto& [width, height] : {std::pair{32U, 32U}, {37U, 23U}, {5U, 3U}, {64U, 9U}}) {
    for (const std::uint32_t block : {2U, 3U, 4U}) {
      const std::uint32_t columns = width / block, rows = height / block;
      const std::uint32_t between =
          (block - 1) * (rows * (columns == 0 ? 0 : columns - 1) + (rows == 0 ? 0 : rows - 1) * width);
      MultirateConfig lee;
      lee.block = block;
      UndersampleConfig kim;
      kim.block = block;
      kim.position = 1000;
      for (const Sampling& s : {stage.multirate(small(width, height), lee).sampling,
                                stage.undersample(small(width, height), kim).sampling}) {
        EXPECT_EQ(s.wanted, width * height);
        EXPECT_EQ(s.passed, between) << width << 'x' << height << ", block " << block;
        EXPECT_EQ(s.traced, s.wanted - between);
        EXPECT_EQ(failed(s, Check::kBorder), s.wanted - columns * rows - between);
        EXPECT_EQ(failing(s), Names{});
        EXPECT_EQ(s.halo + s.correction + s.background, 0U);
      }
    }
  }
}

TEST(Sampling, TracedAreReferencesAndThoseThatFailed) {
  for (const traces::Scene& scene : {showcase_scene(), traces::open_scene("cornell")}) {
    const Stage stage(scene);
    for (const std::uint32_t block : {2U, 3U, 4U}) {
      MultirateConfig lee;
      lee.block = block;
      UndersampleConfig kim;
      kim.block = block;
      kim.correction = Correction::kFour;
      for (const Halo halo : {Halo::kReload, Halo::kRetrace}) {
        lee.halo = kim.halo = halo;
        for (const Sampled& run : {stage.multirate(small(61, 35), lee), stage.undersample(small(61, 35), kim)}) {
          const Sampling& s = run.sampling;
          const std::uint64_t references = (61 / block) * (35 / block);
          std::uint64_t marked = 0, interpolated = 0;
          for (const SampleMark mark : run.marks) {
            marked += (mark & kReferenceMark) != 0 ? 1 : 0;
            interpolated += (mark & kTracedMark) == 0 ? 1 : 0;
          }
          EXPECT_EQ(s.wanted, 61U * 35U);
          EXPECT_EQ(s.checked + s.failed[static_cast<std::size_t>(Check::kBorder)], s.wanted - references);
          EXPECT_EQ(s.traced - s.halo - s.correction, s.wanted - s.passed);
          EXPECT_EQ(marked, references);
          EXPECT_EQ(interpolated, s.passed);
          EXPECT_EQ(s.halo == 0, halo == Halo::kReload);
          EXPECT_LE(s.background, s.wanted);
          EXPECT_EQ(run.rays[0] >= s.traced, true) << "each traced sample has a primary ray";
        }
      }
    }
  }
}

TEST(Sampling, TwoObjectsInOnePlaneFailOnlyByObject) {
  const Room room = Room().add(sheet(-10, 0)).add(sheet(0, 10));
  EXPECT_EQ(failing(room.under()), Names{"object"});
  EXPECT_EQ(failing(room.multi()), Names{"object"});
  EXPECT_EQ(failed(room.under(), Check::kObject), 8U) << "one in each row of references";
  EXPECT_EQ(room.multi().failed, room.under().failed);
}

TEST(Sampling, AnEdgeOfOneObjectFailsOnlyByNormal) {
  for (const float rise : {1.0F, -1.0F}) {
    const Room room = Room().add(fold(rise));
    EXPECT_EQ(failing(room.under()), Names{"normal"}) << rise;
    EXPECT_EQ(failing(room.multi()), Names{"normal"}) << rise;
    EXPECT_EQ(failed(room.multi(), Check::kNormal), 8U);
    UndersampleConfig loose;
    loose.normal = -1;
    EXPECT_EQ(failing(room.under(loose)), Names{}) << "not compared";
  }
}

TEST(Sampling, AShadowsEdgeFailsOnlyByShadow) {
  Room room;
  room.add(sheet(-10, 10)).add(sheet(0, 10, 9));  // the second sheet is behind the camera
  room.scene.lights.push_back(
      {.kind = traces::Light::Kind::kDirectional, .direction = {0, 0, -1}, .intensity = glm::vec3(1)});
  EXPECT_EQ(failing(room.under()), Names{"shadow"});
  EXPECT_EQ(failing(room.multi()), Names{"shadow"});
  EXPECT_EQ(failed(room.under(), Check::kShadow), 8U);
}

TEST(Sampling, ShadowsAreDistinguishedByLight) {
  Room room;
  // A screen, seen edge-on, blocks a light on either side.
  room.add(sheet(-10, 10)).add(traces::make_quad("screen", {0, -10, 0.01F}, {0, 0, 3}, {0, 20, 0}, 1));
  for (const float side : {1.0F, -1.0F}) {
    room.scene.lights.push_back({.kind = traces::Light::Kind::kDirectional,
                                 .direction = glm::normalize(glm::vec3(side, 0, -1)),
                                 .intensity = glm::vec3(0.3F)});
  }
  EXPECT_EQ(failing(room.multi()), Names{"shadow"});
  EXPECT_EQ(failing(room.under()), Names{"shadow"});
}

TEST(Sampling, ParallelSheetsFailByPositionAndConvexity) {
  const Room far = Room().add(join_meshes(sheet(-10, 0, -2), sheet(0, 10)));
  EXPECT_EQ(failing(far.under()), (Names{"position", "convexity"}));
  EXPECT_EQ(failing(far.multi()), Names{}) << "Lee's checks do not see it";
  const Room near = Room().add(join_meshes(sheet(-10, 0, -0.3F), sheet(0, 10)));
  EXPECT_EQ(failing(near.under()), Names{"convexity"});
  UndersampleConfig strict;
  strict.position = 1e-4;
  EXPECT_EQ(failing(Room().add(sheet(-10, 10)).under(strict)), Names{"position"}) << "pixels are farther apart";
}

TEST(Sampling, TextureCoordinatesFailOnlyWhereTheyWrap) {
  for (const float repeats : {1.0F, 20.0F}) {
    Room room;
    const std::uint32_t white = add_texture(room.scene, 2, true, [](auto, auto) { return 0xffffffffU; });
    const traces::Mesh wall = traces::make_quad("wall", {-10.5F, -10.5F, 0}, {21, 0, 0}, {0, 21, 0}, 1, repeats);
    EXPECT_EQ(failing(Room(room).add(wall).under()), Names{}) << "no texture";
    room.add(wall, {.base_texture = {white}});
    EXPECT_EQ(failing(room.under()), repeats > 1 ? Names{"texture"} : Names{});
    EXPECT_EQ(failing(room.multi()), Names{});
    UndersampleConfig loose;
    loose.texture = 0;
    EXPECT_EQ(failing(room.under(loose)), Names{}) << "not compared";
  }
}

TEST(Sampling, AColourInAMirrorFailsByColour) {
  Room room = mirror();
  room.add(behind(-10, 0), {.base_colour = {1, 0, 0}}).add(behind(0, 10), {.base_colour = {0, 1, 0}});
  EXPECT_EQ(failing(room.under()), Names{"colour"});
  EXPECT_EQ(failing(room.multi()), Names{"secondary_object"});
  EXPECT_EQ(failed(room.under(), Check::kColour), 8U);
  UndersampleConfig kim;
  kim.colour = 2;
  EXPECT_EQ(failing(room.under(kim)), Names{}) << "not compared";
  MultirateConfig lee;
  lee.secondary_checks = false;
  EXPECT_EQ(failing(room.multi(lee)), Names{}) << "not compared";
  EXPECT_EQ(failing((mirror().add(behind(-10, 0)).add(behind(0, 10))).under()), Names{}) << "the same colour";
}

TEST(Sampling, AnEdgeInAMirrorFailsBySecondaryNormal) {
  Room room = mirror();
  room.add(join_meshes(traces::make_quad("left", {0, -10, 8}, {-10, 0, 10}, {0, 20, 0}, 1),
                       traces::make_quad("right", {10, -10, 18}, {-10, 0, -10}, {0, 20, 0}, 1)));
  EXPECT_EQ(failing(room.multi()), Names{"secondary_normal"});
  EXPECT_EQ(failing(room.under()), Names{});
}

TEST(Sampling, AShadowInAMirrorFailsBySecondaryShadow) {
  Room room = mirror();
  room.add(behind(-10, 10)).add(traces::make_quad("screen", {-5, 0, 4}, {0, 0, 4}, {0, 6, 0}, 1));
  room.scene.lights.push_back({.kind = traces::Light::Kind::kDirectional,
                               .direction = glm::normalize(glm::vec3(1, 0, 0.3F)),
                               .intensity = glm::vec3(0.2F)});
  EXPECT_EQ(failing(room.multi()), Names{"secondary_shadow"});
}

TEST(Sampling, BackgroundSamplesMissOrAreBetweenMisses) {
  const Room room = Room().add(sheet(-10, 0));
  for (const Sampling& s : {room.under(), room.multi()}) {
    EXPECT_EQ(s.background, 8U * 16U);
    EXPECT_LT(s.traced_background, s.background);
    EXPECT_GT(s.traced_background, s.background / 4);
    EXPECT_EQ(failed(s, Check::kObject), 8U);
  }
  const Room empty = Room().add(sheet(-10, 10, 100));  // behind the camera
  EXPECT_EQ(empty.under().background, 256U);
  EXPECT_EQ(empty.under().traced_background, empty.under().traced);
  EXPECT_EQ(failing(empty.under()), Names{}) << "misses are like each other";
}

TEST(Sampling, TwoRunsAreEqualToTheLastCounterAndWordOfWork) {
  const Stage stage(showcase_scene());
  UndersampleConfig kim;
  kim.correction = Correction::kFour;
  const auto expect_repeated = [&](auto&& run) {
    const Sampled a = run(), b = run();
    expect_equal(a.sampling, b.sampling);
    EXPECT_EQ(a.marks, b.marks);
    EXPECT_EQ(a.rays, b.rays);
    ASSERT_EQ(a.works.size(), b.works.size());
    for (std::size_t w = 0; w < a.works.size(); ++w) {
      const traces::TileWork &x = a.works[w], &y = b.works[w];
      EXPECT_EQ(x.walk, y.walk);
      EXPECT_EQ(x.sources, y.sources);
      EXPECT_EQ(x.access_begin, y.access_begin);
      EXPECT_EQ(x.accesses.size(), y.accesses.size());
      ASSERT_EQ(x.nodes.size(), y.nodes.size());
      for (std::size_t n = 0; n < x.nodes.size(); ++n) {
        EXPECT_EQ(x.nodes[n].items, y.nodes[n].items);
        EXPECT_EQ(x.nodes[n].kernel, y.nodes[n].kernel);
        EXPECT_EQ(x.nodes[n].inputs.size(), y.nodes[n].inputs.size());
      }
    }
  };
  expect_repeated([&] { return stage.multirate(small(48, 32), {}, 2, true); });
  expect_repeated([&] { return stage.undersample(small(48, 32), kim, true); });
}

// Tests of the difference between interpolated and traced samples, and of the effect of textures on similarity checks.

constexpr float kStep = 1.0F / 255;  // one step of the frame buffer

Stage stage_of(const traces::Scene& scene) { return Stage(scene, traces::look_at("c", {0, 0, 4}, {0, 0, 0}, 0.5F)); }

float greatest_difference(const Sampled& a, const Sampled& b) {
  float most = 0;
  for (std::size_t i = 0; i < a.rgb.size(); ++i) most = std::max(most, std::abs(a.rgb[i] - b.rgb[i]));
  return most;
}

double mean_squared_error(const Sampled& a, const Sampled& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.rgb.size(); ++i) sum += std::pow(static_cast<double>(a.rgb[i] - b.rgb[i]), 2);
  return sum / static_cast<double>(a.rgb.size());
}

/// Returns a wall whose colour changes evenly from left to right and from bottom to top.
traces::Scene ramp() {
  traces::Scene scene = empty_scene();
  scene.ambient = glm::vec3(1);
  traces::Mesh wall = traces::make_quad("wall", {-1.25F, -1.25F, 0}, {2.5F, 0, 0}, {0, 2.5F, 0}, 1);
  for (const glm::vec3& at : wall.positions) {
    wall.colours.emplace_back(0.5F + 0.4F * at.x, 0.5F + 0.4F * at.y, 0.5F - 0.2F * at.x - 0.2F * at.y, 1);
  }
  traces::add_object(scene, std::move(wall), traces::add_material(scene, {.base_colour = glm::vec3(1)}));
  return scene;
}

TEST(FaintColours, AlwaysPassTheCheckAndBrighterOnesMayFail) {
  for (const float threshold : {1e-6F, 0.001F, 0.02F, 0.08F, 0.5F, 2.0F}) {
    const float faint = largest_faint_channel(threshold);
    const auto apart = [&](const glm::vec3& a, const glm::vec3& b) {
      return std::sqrt(encoded_distance_squared<float>({a.x, a.y, a.z}, {b.x, b.y, b.z}));
    };
    for (std::uint32_t i = 0; i < 200; ++i) {
      const auto channel = [&](int k) { return faint * static_cast<float>(sim::hash(i, k) % 5) / 4; };
      EXPECT_LT(apart({channel(0), channel(1), channel(2)}, {channel(3), channel(4), channel(5)}), threshold);
    }
    EXPECT_LT(apart(glm::vec3(faint), glm::vec3(0)), threshold);
    if (threshold < 0.05F) {
      EXPECT_GT(apart(glm::vec3(1.2F * faint), glm::vec3(0)), threshold);
    }
  }
}

TEST(Interpolation, AnEvenRampIsMatchedExactly) {
  const Stage stage = stage_of(ramp());
  for (const std::uint32_t block : {2U, 3U, 4U}) {
    for (const std::uint32_t grid : {1U, 2U}) {
      const Sampled full = stage.full(small(33, 25), grid * grid);
      MultirateConfig lee;
      lee.block = block;
      const Sampled multi = stage.multirate(small(33, 25), lee, grid);
      EXPECT_GT(multi.sampling.passed * 3, multi.sampling.wanted);
      EXPECT_LE(greatest_difference(multi, full), 1e-4F) << "block " << block << ", grid " << grid;
      UndersampleConfig kim;
      kim.block = block;
      kim.samples = grid * grid;
      kim.position = 1;
      const Sampled under = stage.undersample(small(33, 25), kim);
      EXPECT_EQ(under.sampling.passed, multi.sampling.passed);
      EXPECT_LE(greatest_difference(under, full), 1e-4F) << "block " << block << ", grid " << grid;
    }
  }
}

TEST(Interpolation, AFarLightIsMatchedWithinAStepOfTheFrameBuffer) {
  traces::Scene scene = empty_scene();
  add_wall(scene, 0, 10, {.base_colour = {0.9F, 0.5F, 0.2F}});
  scene.lights.push_back({.position = {10, 5, 20}, .intensity = glm::vec3(500)});
  const Stage stage = stage_of(scene);
  const Sampled full = stage.full(small(32, 32));
  EXPECT_LE(greatest_difference(stage.multirate(small(32, 32), {}), full), kStep);
  EXPECT_LE(greatest_difference(stage.undersample(small(32, 32), {}), full), kStep);
}

TEST(Interpolation, NormalsAreInterpolatedAndThenShaded) {
  // A ball under one light: colours do not change evenly, but normals nearly do.
  traces::Scene scene = empty_scene();
  traces::add_object(scene, traces::make_sphere("ball", {0, 0, 0}, 3, 40),
                     traces::add_material(scene, {.base_colour = glm::vec3(1)}));
  scene.lights.push_back(
      {.kind = traces::Light::Kind::kDirectional, .direction = {0, 0, -1}, .intensity = glm::vec3(0.9F)});
  const Stage stage(scene, traces::look_at("c", {0, 0, 20}, {0, 0, 0}, 0.2F));
  const RenderConfig render = small(48, 48);
  const Sampled full = stage.full(render);
  MultirateConfig lee;
  lee.block = 4;
  lee.normal = 0.8;
  UndersampleConfig kim;
  kim.block = 4;
  kim.position = 1;
  kim.normal = 0.8;
  kim.correction = Correction::kOff;
  const Sampled coloured = stage.multirate(render, lee), shaded = stage.undersample(render, kim);
  EXPECT_GT(shaded.sampling.passed * 2, shaded.sampling.checked);
  EXPECT_EQ(shaded.marks, coloured.marks) << "only what is done with those that pass differs";
  EXPECT_LT(4 * mean_squared_error(shaded, full), mean_squared_error(coloured, full));
}

TEST(Interpolation, TexturesAreLookedUpAtInterpolatedCoordinates) {
  traces::Scene scene = empty_scene();
  scene.ambient = glm::vec3(1);
  const std::uint32_t checks = add_texture(
      scene, 32, true, [](std::uint32_t x, std::uint32_t y) { return (x ^ y) & 1U ? 0xffffffffU : 0xff000000U; });
  add_wall(scene, 0, 2.5F, {.base_colour = glm::vec3(1), .base_texture = {checks}});
  const Stage stage = stage_of(scene);
  const Sampled full = stage.full(small(64, 64));
  UndersampleConfig kim;
  kim.position = 1;
  const Sampled under = stage.undersample(small(64, 64), kim);
  EXPECT_GT(under.sampling.passed * 2, under.sampling.wanted);
  EXPECT_LE(greatest_difference(under, full), 0.005F);
  EXPECT_GT(greatest_difference(stage.multirate(small(64, 64), {}), full), 0.2F) << "colours would be smeared";
}

TEST(Interpolation, MirroredLightIsInterpolatedAsAColour) {
  // Half a mirror in front of a wall with a colour gradient: only mirrored light is interpolated.
  traces::Scene scene = empty_scene();
  scene.ambient = glm::vec3(0.5F);
  add_wall(scene, 0, 4, {.base_colour = glm::vec3(0.8F), .mirror = 0.5F});
  traces::Mesh behind = traces::make_quad("behind", {10, -10, 8}, {-20, 0, 0}, {0, 20, 0}, 1);
  for (const glm::vec3& at : behind.positions) behind.colours.emplace_back(0.5F + 0.04F * at.x, 0.5F, 0.3F, 1);
  traces::add_object(scene, std::move(behind), traces::add_material(scene, {.base_colour = glm::vec3(1)}));
  const Stage stage = stage_of(scene);
  const Sampled full = stage.full(small(32, 32)), under = stage.undersample(small(32, 32), {});
  EXPECT_GT(under.sampling.passed * 2, under.sampling.wanted);
  EXPECT_LE(greatest_difference(under, full), 1e-4F);
}

TEST(Interpolation, ColoursAreClampedBeforeTheyAreMixed) {
  traces::Scene scene = empty_scene();
  scene.background = glm::vec3(40);
  add_wall(scene, -100, 1, {});
  const Stage stage = stage_of(scene);
  for (const float value : stage.multirate(small(9, 9), {}).rgb) EXPECT_EQ(value, 1.0F);
}

TEST(TextureChecks, AnOcclusionMapIsSampledBetweenItsReferences) {
  Room room;
  const std::uint32_t dirt = add_texture(
      room.scene, 4, false, [](std::uint32_t x, std::uint32_t y) { return 0xff000000U + 64 * ((x + y) % 4); });
  const traces::Mesh wall = traces::make_quad("wall", {-1.2F, -1.2F, 0}, {2.4F, 0, 0}, {0, 2.4F, 0}, 1);
  room.add(wall, {.base_colour = glm::vec3(0.7F), .occlusion_texture = {dirt}});
  UndersampleConfig kim;
  kim.position = 1000;
  kim.texture = 0;
  for (const Fusion fusion : {Fusion::kOn, Fusion::kOff}) {
    RenderConfig render = small(16, 16);
    render.fusion = fusion;
    const Stage stage = room.stage();
    const Sampled run = stage.undersample(render, kim);
    EXPECT_EQ(failing(run.sampling), Names{});
    EXPECT_GT(run.sampling.passed, 0U);
    const Sampled full = stage.full(render);
    for (std::size_t i = 0; i < full.rgb.size(); ++i) EXPECT_NEAR(run.rgb[i], full.rgb[i], 1e-5F);
    EXPECT_GT(std::ranges::max(full.rgb), 2 * std::ranges::min(full.rgb)) << "which is no even wall";
  }
  EXPECT_EQ(failing(room.multi()), Names{});
}

TEST(TextureChecks, AnOcclusionMapFailsByTextureWhereItsCoordinatesWrapAndByDetailIfTheyAreOthers) {
  Room room;
  const std::uint32_t dirt = add_texture(room.scene, 2, false, [](auto, auto) { return 0xff808080U; });
  const traces::Mesh wall = traces::make_quad("wall", {-10.5F, -10.5F, 0}, {21, 0, 0}, {0, 21, 0}, 1, 20);
  EXPECT_EQ(failing(Room(room).add(wall, {.occlusion_texture = {dirt}}).under()), Names{"texture"});
  traces::Mesh second = sheet(-10, 10);
  second.second_uvs.assign(second.positions.size(), {0, 0});
  room.add(second, {.occlusion_texture = {.texture = dirt, .second_uv = true}});
  EXPECT_EQ(failing(room.under()), Names{"detail"});
  EXPECT_EQ(room.under().passed, 0U);
}

/// Returns a wall whose texture is dark on the left and bright on the right.
Room two_greys() {
  Room room;
  const std::uint32_t grey = add_texture(
      room.scene, 2, true, [](std::uint32_t x, std::uint32_t) { return x == 0 ? 0xff202020U : 0xffe0e0e0U; });
  room.scene.textures[grey].filter = traces::Texture::Filter::kNearest;
  const traces::Mesh wall = traces::make_quad("wall", {-10.5F, -10.5F, 0}, {21, 0, 0}, {0, 21, 0}, 1);
  return room.add(wall, {.base_texture = {grey}});
}

TEST(TextureChecks, ATexturesEdgeFailsByTextureIfColoursAreCompared) {
  const Room room = two_greys();
  MultirateConfig lee;
  EXPECT_EQ(failing(room.multi(lee)), Names{}) << "not compared";
  lee.texture = 0.5;
  EXPECT_EQ(failing(room.multi(lee)), Names{"texture"});
  EXPECT_EQ(failed(room.multi(lee), Check::kTexture), 8U) << "one in each row of references";
  EXPECT_EQ(room.multi(lee).rough, 0U);
  lee.texture = 1.4;
  EXPECT_EQ(failing(room.multi(lee)), Names{}) << "sqrt(3) times 0.75";
  lee.secondary_checks = false;
  lee.texture = 0.5;
  EXPECT_EQ(failing(room.multi(lee)), Names{"texture"});
  Room lit = Room().add(sheet(-10, 10));
  lit.scene.lights.push_back({.position = {0, 0, 0.2F}, .intensity = glm::vec3(0.2F)});
  lee.texture = 0.01;
  EXPECT_EQ(failing(lit.multi(lee)), Names{}) << "no texture";
}

TEST(TextureChecks, ATexturesEdgeThatPassesIsRoughForTheRateAlone) {
  const Room room = two_greys();
  MultirateConfig lee;
  lee.rate_control = RateControl::kHysteresis;
  lee.rate_texture = 2;
  const Sampling without = room.multi(lee);
  lee.rate_texture = 0.5;
  const Sampling with = room.multi(lee);
  EXPECT_EQ(with.passed, without.passed);
  EXPECT_EQ(without.rough, 0U);
  EXPECT_EQ(with.rough, 8U) << "one in each row of references";
  EXPECT_FLOAT_EQ(with.similar[0], 1 - static_cast<float>(with.rough) / static_cast<float>(with.checked));
  EXPECT_EQ(without.similar[0], 1);
  lee.texture = 0.5;
  EXPECT_EQ(room.multi(lee).rough, 0U) << "what is traced needs no finer rate";
}

TEST(FirstFailed, ASampleIsTracedForTheFirstCheckThatItFails) {
  const Room far = Room().add(join_meshes(sheet(-10, 0, -2), sheet(0, 10)));
  const Sampling s = far.under();
  EXPECT_EQ(failed(s, Check::kPosition), failed(s, Check::kConvexity));
  EXPECT_EQ(s.first_failed[static_cast<std::size_t>(Check::kPosition)], failed(s, Check::kPosition));
  EXPECT_EQ(s.first_failed[static_cast<std::size_t>(Check::kConvexity)], 0U);
  EXPECT_EQ(s.first_failed[static_cast<std::size_t>(Check::kBorder)], failed(s, Check::kBorder));
  const Sampling all = Stage(showcase_scene()).undersample(small(61, 35), {}).sampling;
  EXPECT_EQ(std::accumulate(all.first_failed.begin(), all.first_failed.end(), std::uint64_t{0}),
            all.checked - all.passed + failed(all, Check::kBorder));
}

}  // namespace
}  // namespace kernels
