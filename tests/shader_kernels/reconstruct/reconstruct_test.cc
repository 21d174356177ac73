#include "shader_kernels/kernels/reconstruct.h"

#include <algorithm>
#include <cmath>
#include <tuple>
#include <vector>

#include <gtest/gtest.h>

#include "shader_kernels/programs/adaptive/reconstruct.h"
#include "tests/shader_kernels/reconstruct/reconstruct_harness.h"
#include "tests/shader_kernels/showcase.h"

// Tests of subpixel reconstruction antialiasing: each pixel has one shaded sample and four geometry samples.

namespace kernels {
namespace {

using traces::RayKind;
using Filters = ReconstructProgram::Filters;

/// Returns a configuration whose filter reads no other sample.
ReconstructConfig alone() {
  ReconstructConfig config;
  config.radius = 0;
  return config;
}

/// Returns origins and directions of rays, sorted.
auto sorted(const std::vector<traces::Ray>& rays) {
  std::vector<std::tuple<float, float, float, float, float, float>> all;
  for (const traces::Ray& r : rays) {
    all.emplace_back(r.origin.x, r.origin.y, r.origin.z, r.direction.x, r.direction.y, r.direction.z);
  }
  std::ranges::sort(all);
  return all;
}

/// Returns a scene without mirrors: a wall, seen from the front, with the shadow of a slanted plate.
traces::Scene shadowed_wall() {
  traces::Scene scene = empty_scene();
  scene.ambient = glm::vec3(0.2F);
  add_wall(scene, 0, 8, {.name = "wall"});
  traces::add_object(scene, traces::make_quad("plate", {-0.2F, -0.6F, 1.5F}, {0.9F, 0.3F, 0}, {-0.3F, 1, 0}, 1),
                     traces::add_material(scene, {.name = "plate", .base_colour = {0.9F, 0.3F, 0.2F}}));
  traces::Light light;
  light.position = {3, 1, 4};
  light.intensity = glm::vec3(20);
  scene.lights.push_back(light);
  scene.cameras.push_back(traces::look_at("c", {0, 0, 6}, {0, 0, 0}, 0.8F));
  return scene;
}

TEST(Similarity, FallsWithDepthAndWithTheAngleOfNormalsAndIsZeroAcrossAShadowsEdge) {
  const VisibleRecord<float> here{{0, 0, 1}, 2, 1};
  const auto weight = [&](const VisibleRecord<float>& other, float bend) {
    return Similarity<float>(here, other, bend).filter_weight();
  };
  EXPECT_EQ(weight(here, 4), 1.0F);
  EXPECT_NEAR(weight({{0, 0, 1}, 3.5F, 1}, 4), std::exp(-2.25F), 1e-5F);
  EXPECT_NEAR(weight({{0, 0.6F, 0.8F}, 2, 1}, 4), std::exp(-0.64F), 1e-5F) << "1 - n.n = 0.2, over 0.25";
  EXPECT_NEAR(weight({{0, 0.6F, 0.8F}, 2, 1}, 0.25F), std::exp(-0.0025F), 1e-5F) << "as printed";
  EXPECT_NEAR(weight({{0, 0, -1}, 2, 1}, 0.25F), std::exp(-0.0625F), 1e-5F) << "dot products below 0 count as 0";
  EXPECT_EQ(weight({{0, 0, 1}, 2, 3}, 4), 0.0F) << "another light is hidden";
  EXPECT_EQ(weight({{0, 0, 1}, kMissDepth, 1}, 4), 0.0F);
  EXPECT_EQ(weight({{0, 0, 1}, kNoBranchDepth, 1}, 4), 0.0F);
}

/// Filters a row of two pixels. `others`: geometry records of all samples that are not shaded.
std::vector<ColourRecord<float>> filtered(const VisibleRecord<float>& left, const VisibleRecord<float>& right,
                                          const VisibleRecord<float>& others) {
  std::vector<VisibleRecord<float>> visible(8, others);
  visible[0] = left;
  visible[1] = right;
  std::vector<ColourRecord<float>> colours(8), pixels(2);
  colours[0].rgb = {1, 0, 0};
  colours[1].rgb = {0, 1, 0};
  Reconstruct<1, false>::Ports<float> ports;
  ports.finished = {2, 0.5F, 0, 2, 0, 1, 0, 0};
  ports.visible.bind(visible.data());
  ports.colours.bind(colours.data());
  ports.pixels.bind(pixels.data());
  ports.bend = 4;
  ports.apart = 2;
  for (std::uint32_t i = 0; i < 2; ++i) Reconstruct<1, false>::body<float>(i, ports);
  return pixels;
}

TEST(ReconstructKernel, EachSampleTakesTheMeanOfSimilarShadedOnes) {
  const VisibleRecord<float> lit{{0, 0, 1}, 2, 0}, dark{{0, 0, 1}, 2, 1}, far{{0, 0, 1}, 50, 0};
  EXPECT_NEAR(filtered(lit, lit, lit)[0].rgb.x, 0.5F, 1e-6F) << "none of what lies outside the picture";
  EXPECT_NEAR(filtered(lit, lit, lit)[1].rgb.y, 0.5F, 1e-6F);
  const auto edge = filtered(lit, dark, dark);
  EXPECT_NEAR(edge[0].rgb.x, 0.25F, 1e-6F) << "the shaded one is lit, the other three are dark";
  EXPECT_NEAR(edge[0].rgb.y, 0.75F, 1e-6F);
  EXPECT_NEAR(edge[1].rgb.y, 1.0F, 1e-6F);
  const auto alone = filtered(lit, lit, far);
  EXPECT_NEAR(alone[0].rgb.x, 0.25F * 0.5F + 0.75F, 1e-6F) << "no shaded one is like three: their pixel's own";
}

TEST(Reconstruct, SamplesAreThoseOfFourOnARotatedGrid) {
  const Stage stage(shadowed_wall());
  RenderConfig render = small(24, 17);
  const SpyTracer ours(stage.tracer), theirs(stage.tracer);
  reconstruct(stage, render, {}, Filters::kApart, &ours);
  render.samples = SamplePattern::kRotated;
  kernels::render(stage.image, stage.camera, theirs, render, 4);
  // Tiles compute their halos, so some samples are traced several times; a single tile has none.
  render.tile = 128;
  render.samples = SamplePattern::kRegular;
  const SpyTracer whole(stage.tracer);
  reconstruct(stage, render, {}, Filters::kApart, &whole);
  for (const RayKind kind : {RayKind::kPrimary, RayKind::kShadow}) {
    EXPECT_EQ(sorted(whole.seen(kind)), sorted(theirs.seen(kind)));
    EXPECT_GT(ours.seen(kind).size(), whole.seen(kind).size());
  }
}

TEST(RotatedGrid, HasASampleInEachRowAndEachColumnOfCells) {
  for (const std::uint32_t grid : {1U, 2U, 3U, 4U}) {
    const std::uint32_t samples = grid * grid;
    const Stage stage(shadowed_wall());
    RenderConfig render = small(1, 1);
    render.samples = SamplePattern::kRotated;
    const SpyTracer spy(stage.tracer);
    kernels::render(stage.image, stage.camera, spy, render, samples);
    const CameraUniforms<float> camera = camera_uniforms(stage.camera, 1, 1);
    std::vector<std::uint32_t> columns(samples), rows(samples);
    for (const traces::Ray& ray : spy.seen(RayKind::kPrimary)) {
      const Vec3<float> d{ray.direction.x, ray.direction.y, ray.direction.z};
      // A direction's component along the view is the distance of the picture plane.
      const Vec3<float> forward = camera.corner + camera.right * 0.5F + camera.down * 0.5F;
      const Vec3<float> in_picture = d * (dot(forward, forward) / dot(d, forward)) - camera.corner;
      const float n = static_cast<float>(samples);
      const float x = dot(in_picture, camera.right) / dot(camera.right, camera.right) * n;
      const float y = dot(in_picture, camera.down) / dot(camera.down, camera.down) * n;
      EXPECT_NEAR(x - std::floor(x), 0.5F, 1e-2F);
      EXPECT_NEAR(y - std::floor(y), 0.5F, 1e-2F);
      ++columns.at(static_cast<std::size_t>(x));
      ++rows.at(static_cast<std::size_t>(y));
    }
    EXPECT_EQ(columns, std::vector<std::uint32_t>(samples, 1)) << samples;
    EXPECT_EQ(rows, std::vector<std::uint32_t>(samples, 1)) << samples;
  }
}

TEST(Reconstruct, CastsTheRaysOfFourSamplesAndShadesOne) {
  const Stage stage(traces::open_scene("cornell"));
  RenderConfig render = small(40, 32);
  render.depth = 2;
  const Sampled ours = reconstruct(stage, render);
  render.samples = SamplePattern::kRotated;
  const Sampled four = stage.full(render, 4);
  EXPECT_EQ(ours.rays, four.rays);
  EXPECT_GT(ours.rays[static_cast<std::size_t>(RayKind::kReflection)], 0U);
  EXPECT_EQ(ours.sampling.traced, 40U * 32U * 4U);
  EXPECT_EQ(ours.sampling.wanted, 40U * 32U * 16U);
  const Sampled one = reconstruct(stage, render, alone());
  EXPECT_EQ(one.sampling.traced, 40U * 32U);
  render.samples = SamplePattern::kRegular;
  const Sampled sraa = reconstruct(stage, render, {}, Filters::kOne);
  for (std::size_t kind = 1; kind < sraa.rays.size(); ++kind) {
    EXPECT_EQ(sraa.rays[kind], one.rays[kind]) << "by the shaded samples alone";
  }
  EXPECT_EQ(sraa.rays[0], four.rays[0]);
}

class ReconstructIn : public testing::TestWithParam<const char*> {
 protected:
  const Stage stage_{traces::open_scene(GetParam())};
};
INSTANTIATE_TEST_SUITE_P(BuiltIn, ReconstructIn, testing::Values("cornell", "teapot"),
                         [](const auto& i) { return std::string(i.param); });

TEST_P(ReconstructIn, ThePictureIsTheSameForEveryTileHaloAttributeStorageAndStream) {
  for (const Filters filters : {Filters::kApart, Filters::kOne}) {
    for (const std::uint32_t radius : {0U, 1U, 2U}) {
      ReconstructConfig c;
      c.radius = radius;
      RenderConfig render = small(37, 29);
      render.tile = 128;
      const Sampled whole = reconstruct(stage_, render, c, filters);
      for (const std::uint32_t tile : {1U, 16U, 40U}) {
        for (const Halo halo : {Halo::kReload, Halo::kRetrace}) {
          render.tile = tile;
          render.streams = tile == 16 ? Streams::kDivergent : Streams::kCompacted;
          c.halo = halo;
          c.attributes = tile == 16 ? AttributeStorage::kDram : AttributeStorage::kTile;
          const Sampled cut = reconstruct(stage_, render, c, filters, nullptr, true);
          EXPECT_EQ(cut.rgb, whole.rgb) << "radius " << radius << ", tile " << tile;
          EXPECT_EQ(cut.marks, whole.marks);
          EXPECT_EQ(cut.sampling.background, whole.sampling.background);
          EXPECT_EQ(cut.sampling.traced - cut.sampling.halo, whole.sampling.traced);
          EXPECT_EQ(cut.sampling.halo != 0, halo == Halo::kRetrace && radius != 0);
        }
      }
    }
  }
}

TEST_P(ReconstructIn, PicturesAreNearerToSixteenSamplesThanThoseOfOne) {
  const RenderConfig render = small(96, 64);
  const std::vector<float> truth = stage_.full(render, 16).rgb;
  const double ours = squared_error(reconstruct(stage_, render).rgb, truth);
  const double none = squared_error(reconstruct(stage_, render, alone()).rgb, truth);
  EXPECT_LT(ours, 0.4 * none) << "4 dB";
}

TEST(Reconstruct, KeepsAShadowsEdgeThatOneFilterBlurs) {
  const Stage stage(shadowed_wall());
  const RenderConfig render = small(96, 96);
  const std::vector<float> truth = stage.full(render, 16).rgb;
  const Sampled ours = reconstruct(stage, render), sraa = reconstruct(stage, render, {}, Filters::kOne);
  const auto shadow = static_cast<SampleMark>(1U << static_cast<std::uint32_t>(FilterEdge::kShadow));
  double of_ours = 0, of_sraa = 0;
  std::size_t pixels = 0;
  for (std::size_t i = 0; i < ours.marks.size(); ++i) {
    EXPECT_EQ(sraa.marks[i] & shadow, 0) << "sees no shadows";
    if ((ours.marks[i] & ((1U << kWeightShift) - 1)) != shadow) continue;
    ++pixels;
    for (std::size_t c = 3 * i; c < 3 * i + 3; ++c) {
      of_ours += std::pow(ours.rgb[c] - truth[c], 2);
      of_sraa += std::pow(sraa.rgb[c] - truth[c], 2);
    }
  }
  EXPECT_GT(pixels, 100U);
  EXPECT_LT(of_ours, 0.63 * of_sraa) << "2 dB";
}

TEST(Reconstruct, FiltersMirroredLightByTheMirroredGeometry) {
  // Two sheets behind the viewer, a white one and a black one farther away; the mirror shows their edge.
  Room room = mirror();
  room.add(behind(-20, 0.3F), {.base_colour = glm::vec3(0.9F)});
  room.add(traces::make_quad("far", {20, -10, 12}, {-40, 0, 0}, {0, 20, 0}, 1), {.base_colour = glm::vec3(0)});
  const Stage stage = room.stage();
  const RenderConfig render = small(48, 48);
  const std::vector<float> truth = stage.full(render, 16).rgb;
  const Sampled ours = reconstruct(stage, render);
  const double error = squared_error(ours.rgb, truth);
  EXPECT_LT(error, 0.5 * squared_error(reconstruct(stage, render, {}, Filters::kOne).rgb, truth));
  EXPECT_LT(error, 0.5 * squared_error(reconstruct(stage, render, alone()).rgb, truth));
  const auto reflection = static_cast<SampleMark>(1U << static_cast<std::uint32_t>(FilterEdge::kReflection));
  EXPECT_TRUE(std::ranges::any_of(ours.marks, [&](SampleMark m) { return (m & reflection) != 0; }));
}

TEST(Reconstruct, TransfersStayWithinTheirRegionsAndRetracedHalosDoNotWait) {
  const Stage stage(showcase_scene());
  for (const std::uint32_t radius : {0U, 1U, 2U}) {
    for (const Halo halo : {Halo::kReload, Halo::kRetrace}) {
      ReconstructConfig c;
      c.radius = radius;
      c.halo = halo;
      c.attributes = radius == 2 ? AttributeStorage::kDram : AttributeStorage::kTile;
      const RenderConfig render = small(75, 41);
      ReconstructProgram program(stage.image, stage.camera, render, c, Filters::kApart, stage.size(), 0);
      const FrameRequirements needs = program.requirements();
      for (const traces::TileWork& work : run_program(program, stage.tracer, 1, true).works) {
        EXPECT_EQ(work.imports.empty(), halo == Halo::kRetrace || radius == 0 || work.tile == 0);
        for (const traces::WorkNode& node : work.nodes) {
          EXPECT_GT(node.items, 0U);
          if (node.kind == traces::WorkNode::Kind::kRays) {
            EXPECT_LE(node.items, needs.wave_samples * 2);
          }
          if (node.kind != traces::WorkNode::Kind::kTransfer) continue;
          EXPECT_LE(node.offset + node.items, needs.region_bytes[static_cast<std::size_t>(node.region)]);
        }
      }
    }
  }
}

// Tests of `reconstruct` with the colour test, which shades all samples where colours change but geometry does not.

Sampled tested(const Stage& stage, const RenderConfig& render, double colour, ReconstructConfig config = {},
               bool record = false) {
  config.colour = colour;
  return reconstruct(stage, render, config, ReconstructProgram::Filters::kApart, nullptr, record);
}

std::uint64_t rays_of(const Sampled& sampled, RayKind kind) { return sampled.rays[static_cast<std::size_t>(kind)]; }

/// Returns a wall with a chequered sign in ambient light.
Stage signed_wall() {
  traces::Scene scene = empty_scene();
  scene.ambient = glm::vec3(1);
  const std::uint32_t chequers = add_texture(
      scene, 16, true, [](std::uint32_t x, std::uint32_t y) { return (x + y) % 2 != 0 ? 0xffe0e0e0U : 0xff202020U; });
  scene.textures[chequers].filter = traces::Texture::Filter::kNearest;
  add_wall(scene, 0, 2, {.name = "sign", .base_texture = {chequers}});
  add_wall(scene, -0.5F, 12, {.name = "wall", .base_colour = glm::vec3(0.7F)});
  scene.cameras.push_back(traces::look_at("c", {0.3F, 0.2F, 5}, {0, 0, 0}, 0.8F));
  return Stage(scene);
}

TEST(ReconstructColour, AtZeroEverySampleIsShadedAndThePictureIsThatOfFour) {
  for (const char* scene : {"cornell", "teapot"}) {
    const Stage stage(traces::open_scene(scene));
    RenderConfig render = small(40, 24);
    const Sampled all = tested(stage, render, 0), none = tested(stage, render, -1);
    render.samples = SamplePattern::kRotated;
    const Sampled four = stage.full(render, 4);
    for (std::size_t i = 0; i < all.rgb.size(); ++i) EXPECT_NEAR(all.rgb[i], four.rgb[i], 1e-6F) << scene << i;
    EXPECT_EQ(rays_of(all, RayKind::kPrimary), 40U * 24U * (4U + 3U)) << "three once more, to be shaded";
    EXPECT_EQ(all.sampling.traced, none.sampling.traced + 3U * 40U * 24U);
    EXPECT_EQ(all.sampling.correction, 3U * 40U * 24U);
    EXPECT_EQ(all.sampling.passed, 0U);
  }
}

TEST(ReconstructColour, AtOneNothingChangesAsNoContrastIsEnough) {
  const Stage stage(traces::open_scene("cornell"));
  const RenderConfig render = small(40, 24);
  const Sampled one = tested(stage, render, 1), never = tested(stage, render, -1);
  EXPECT_EQ(one.rgb, never.rgb);
  EXPECT_EQ(one.rays, never.rays);
  EXPECT_EQ(one.sampling.checked, 40U * 24U);
  EXPECT_EQ(one.sampling.passed, 40U * 24U);
  EXPECT_EQ(never.sampling.checked, 0U);
}

TEST(ReconstructColour, MendsEdgesOfTexturesAndLeavesThoseOfGeometryToTheFilter) {
  const Stage stage = signed_wall();
  const RenderConfig render = small(96, 96);
  const Sampled truth = stage.full(render, 16);
  const Sampled filtered = tested(stage, render, -1), mended = tested(stage, render, 0.3);
  EXPECT_LT(squared_error(mended.rgb, truth.rgb), 0.5 * squared_error(filtered.rgb, truth.rgb)) << "3 dB";
  // The sign's outline is a depth edge, so only its chequers cause pixels to be listed.
  const std::uint64_t listed = mended.sampling.checked - mended.sampling.passed;
  EXPECT_GT(listed, 500U);
  EXPECT_LT(listed, 96U * 96U / 4U) << "less than the sign";
  EXPECT_EQ(mended.sampling.traced, filtered.sampling.traced + 3 * listed);
}

TEST(ReconstructColour, ComparesOnlySimilarSamples) {
  // Black and white sheets at different depths: the filter separates them, so no pixel is listed.
  Room room;
  room.add(sheet(-10, 0.3F, 0), {.base_colour = glm::vec3(0)}).add(sheet(-10, 10, -3), {.base_colour = glm::vec3(1)});
  EXPECT_EQ(tested(room.stage(), small(32, 32), 0.05).sampling.passed, 32U * 32U);
  // In one plane the sheets are like a texture.
  Room plane;
  plane.add(sheet(-10, 0.3F), {.base_colour = glm::vec3(0)}).add(sheet(0.3F, 10), {.base_colour = glm::vec3(1)});
  EXPECT_EQ(tested(plane.stage(), small(32, 32), 0.05).sampling.passed, 32U * 30U) << "a column on each side";
}

TEST(ReconstructColour, SeesTexturesInMirrors) {
  Room room = mirror();
  room.add(behind(-20, 0.3F), {.base_colour = glm::vec3(0)}).add(behind(0.3F, 20), {.base_colour = glm::vec3(1)});
  const Sampling seen = tested(room.stage(), small(32, 32), 0.3).sampling;
  EXPECT_GT(seen.checked - seen.passed, 16U);
}

TEST(ReconstructColour, ThePictureIsTheSameForEveryTileHaloAttributeStorageAndStream) {
  const Stage stage(showcase_scene());
  for (const std::uint32_t radius : {1U, 2U}) {
    ReconstructConfig c;
    c.radius = radius;
    RenderConfig render = small(37, 29);
    render.tile = 128;
    const Sampled whole = tested(stage, render, 0.2, c);
    EXPECT_LT(whole.sampling.passed, whole.sampling.checked);
    EXPECT_GT(whole.sampling.passed, 0U);
    for (const std::uint32_t tile : {1U, 16U, 40U}) {
      for (const Halo halo : {Halo::kReload, Halo::kRetrace}) {
        render.tile = tile;
        render.streams = tile == 16 ? Streams::kDivergent : Streams::kCompacted;
        c.halo = halo;
        c.attributes = tile == 16 ? AttributeStorage::kDram : AttributeStorage::kTile;
        const Sampled cut = tested(stage, render, 0.2, c, true);
        EXPECT_EQ(cut.rgb, whole.rgb) << "radius " << radius << ", tile " << tile;
        EXPECT_EQ(cut.sampling.passed, whole.sampling.passed);
        EXPECT_EQ(cut.sampling.correction, whole.sampling.correction);
      }
    }
  }
}

}  // namespace
}  // namespace kernels
