#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "block_harness.h"
#include "showcase.h"

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

}  // namespace
}  // namespace kernels
