#include "shader_kernels/programs/adaptive/supersample.h"

#include <algorithm>
#include <set>

#include <gtest/gtest.h>

#include "harness.h"
#include "showcase.h"

namespace kernels {
namespace {

using Reason = Attribute;

/// Returns a configuration with all contrast thresholds at `value`.
SupersampleConfig all_at(double value) {
  SupersampleConfig c;
  c.colour = c.object = c.normal = c.shadow = c.texture = value;
  c.secondary_object = c.secondary_normal = c.secondary_shadow = c.secondary_texture = value;
  return c;
}

double& threshold(SupersampleConfig& c, Reason of) {
  const std::array<double*, kAttributes> all{&c.colour,           &c.object,           &c.normal,
                                             &c.shadow,           &c.texture,          &c.secondary_object,
                                             &c.secondary_normal, &c.secondary_shadow, &c.secondary_texture};
  return *all[static_cast<std::size_t>(of)];
}

/// The result of a frame, and of its last tile, which is the only one if it covers the picture.
struct Result {
  std::vector<float> rgb;
  Sampling sampling;
  TileResult last;
};

struct SupersampleWorld {
  explicit SupersampleWorld(const traces::Scene& scene)
      : image(traces::build_memory_image(scene)), tracer(image), camera(scene.cameras[0]) {}
  Result supersample(const RenderConfig& render, const SupersampleConfig& c, bool record = false) const {
    SupersampleProgram program(image, camera, render, c, 0);
    Result result;
    for (std::uint32_t t = 0; t < program.tiles(); ++t) {
      program.run_tile(t, tracer, record, result.last);
      program.commit_tile(result.last);
    }
    result.rgb = program.picture();
    result.sampling = program.sampling();
    return result;
  }
  std::vector<float> full(RenderConfig render, std::uint32_t samples) const {
    render.samples = SamplePattern::kJittered;
    if (samples == 1) render.samples = SamplePattern::kRegular;
    return kernels::render(image, camera, tracer, render, samples).rgb;
  }

  const traces::MemoryImage image;
  const traces::BvhTracer tracer;
  const traces::Camera camera;
};

/// Returns a configuration with one tile for the whole picture.
RenderConfig whole_picture() {
  RenderConfig render = small(64, 48);
  render.tile = 128;  // in sub-pixels
  return render;
}

class Supersample : public testing::TestWithParam<const char*> {
 protected:
  const SupersampleWorld world_{traces::open_scene(GetParam())};
};
INSTANTIATE_TEST_SUITE_P(BuiltIn, Supersample, testing::Values("cornell", "teapot"),
                         [](const auto& i) { return std::string(i.param); });

TEST_P(Supersample, WithAllThresholdsZeroThePictureIsThatOfSixteenJitteredSamples) {
  const RenderConfig render = small(37, 29);
  const std::vector<float> truth = world_.full(render, 16);
  for (const Packing packing : {Packing::kBlock, Packing::kAtomic, Packing::kNone}) {
    SupersampleConfig c = all_at(0);
    c.packing = packing;
    const Result result = world_.supersample(render, c);
    EXPECT_EQ(result.rgb, truth);
    EXPECT_EQ(result.sampling.active[4], 37U * 29U);
    EXPECT_EQ(result.sampling.traced, 37U * 29U * 17U);
    EXPECT_EQ(result.sampling.wanted, 37U * 29U * 16U);
  }
}

TEST_P(Supersample, WithAllThresholdsOneThePictureIsThatOfOneSample) {
  const RenderConfig render = small(37, 29);
  const Result result = world_.supersample(render, all_at(1));
  EXPECT_EQ(result.rgb, world_.full(render, 1));
  EXPECT_EQ(result.sampling.traced, 37U * 29U);
}

TEST_P(Supersample, ThePictureIsTheSameForEveryTileHaloAttributeStorageAndPacking) {
  for (const SubpixelFilter filter : {SubpixelFilter::kNearest, SubpixelFilter::kBilinear}) {
    SupersampleConfig c;
    c.filter = filter;
    RenderConfig render = small(37, 29);
    const Result reference = world_.supersample(render, c);
    for (const std::uint32_t tile : {1U, 8U, 24U, 72U, 128U}) {
      for (const Halo halo : {Halo::kReload, Halo::kRetrace}) {
        for (const Packing packing : {Packing::kBlock, Packing::kAtomic, Packing::kNone}) {
          c.halo = halo;
          c.packing = packing;
          c.attributes = packing == Packing::kNone ? AttributeStorage::kDram : AttributeStorage::kTile;
          render.tile = tile;
          const Result result = world_.supersample(render, c, true);
          EXPECT_EQ(result.rgb, reference.rgb) << "tile " << tile;
          EXPECT_EQ(result.sampling.active, reference.sampling.active);
          EXPECT_EQ(result.sampling.reasons, reference.sampling.reasons);
          EXPECT_EQ(result.sampling.background, reference.sampling.background);
          EXPECT_EQ(result.sampling.traced - result.sampling.halo, reference.sampling.traced);
          EXPECT_EQ(result.sampling.halo == 0, halo == Halo::kReload || tile == 128);
        }
      }
    }
  }
}

TEST_P(Supersample, FourSamplesAreTracedForEveryActiveSubpixel) {
  const Result result = world_.supersample(small(64, 48), {});
  const auto& active = result.sampling.active;
  EXPECT_EQ(active[0] + active[1] + active[2] + active[3] + active[4], 64U * 48U);
  EXPECT_EQ(result.sampling.traced, 64U * 48U + 4 * (active[1] + 2 * active[2] + 3 * active[3] + 4 * active[4]));
  EXPECT_GT(active[0], 0U);
  EXPECT_GT(active[4], 0U);
}

TEST_P(Supersample, ATileImportsBordersOfThoseToTheLeftAndAbove) {
  SupersampleConfig c;
  const Result result = world_.supersample(small(16, 16), c, true);
  EXPECT_EQ(result.last.tile, 3U);
  const std::vector<traces::Border> expected = {{2, kRightBorder}, {1, kLowerBorder}, {0, kRightBorder}};
  EXPECT_EQ(result.last.work.imports, expected) << "of the corner, too";
  c.halo = Halo::kRetrace;
  EXPECT_TRUE(world_.supersample(small(16, 16), c, true).last.work.imports.empty());
}

/// Returns a room with a mirror wall behind tiles, balls of two materials, a box with sharp edges, many shadows and one
/// ball in focus.
traces::Scene mirrored_room() {
  traces::Scene scene;
  const std::uint32_t checks = add_texture(
      scene, 8, true, [](std::uint32_t x, std::uint32_t y) { return ((x ^ y) & 1U) != 0 ? 0xffd0d0d0U : 0xff404040U; });
  const std::uint32_t tiled = traces::add_material(scene, {.name = "tiled", .base_texture = {checks}});
  const std::uint32_t mirror = traces::add_material(scene, {.name = "mirror", .base_colour = {}, .mirror = 0.9F});
  const std::uint32_t red = traces::add_material(scene, {.name = "red", .base_colour = {0.8F, 0.1F, 0.1F}});
  traces::add_object(scene, traces::make_quad("floor", {-3, -1, 3}, {6, 0, 0}, {0, 0, -3}, 1), tiled);
  traces::add_object(scene, traces::make_quad("plain", {-3, -1, 0}, {6, 0, 0}, {0, 0, -3}, 1), red);
  traces::add_object(scene, traces::make_quad("wall", {-3, -1, -2}, {6, 0, 0}, {0, 3, 0}, 1), mirror);
  traces::add_object(scene, traces::make_sphere("ball", {-0.8F, -0.4F, 0.3F}, 0.5F, 8), red);
  traces::add_object(scene, traces::make_box("box", {0.4F, -1, -0.4F}, {1.2F, -0.2F, 0.4F}), red);
  traces::add_object(scene, traces::make_sphere("focus", {1.3F, 0.6F, 0}, 0.3F, 8), tiled);
  scene.instances.back().focus = true;
  scene.lights.push_back({.position = {-1.5F, 2.5F, 2}, .intensity = glm::vec3(6)});
  scene.lights.push_back({.position = {2, 2, 1}, .intensity = glm::vec3(3)});
  scene.ambient = glm::vec3(0.1F);
  scene.background = {0.3F, 0.4F, 0.6F};
  scene.cameras.push_back(traces::look_at("front", {0, 0.7F, 4.5F}, {0, 0, 0}, 0.7F));
  return scene;
}

/// True if attribute `of` differs between a pixel and a neighbour. A second implementation, for comparison.
bool disagrees(Reason of, const TraitsRecord<float>& own, const TraitsRecord<float>& other) {
  switch (of) {
    case Reason::kObject:
    case Reason::kSecondaryObject:
      return own.object != other.object;
    case Reason::kNormal:
    case Reason::kSecondaryNormal:
      return dot(own.normal, other.normal) < 0.9F;
    case Reason::kShadow:
    case Reason::kSecondaryShadow:
      return own.shadows != other.shadows;
    default:
      return (own.object & kTexturedObject) != 0;
  }
}

/// Returns the sub-pixels at which attribute `of` differs, computed from the samples' records.
std::set<std::uint32_t> disagreeing(Reason of, const TileResult& tile, std::uint32_t pitch, bool focus = false) {
  const auto& kept =
      of < Reason::kSecondaryObject ? tile.buffer.subpixels.traits : tile.buffer.subpixels.secondary_traits;
  const auto at = [&](int x, int y) {
    return kept[static_cast<std::size_t>((y + 2) * static_cast<int>(pitch) + x + 2)];
  };
  const int width = static_cast<int>(tile.width), height = static_cast<int>(tile.height);
  std::set<std::uint32_t> found;
  for (int i = 0; i < 4 * width * height; ++i) {
    const int x = i / 4 % width, y = i / 4 / width;
    const int dx = i % 2 == 1 ? 1 : -1, dy = i / 2 % 2 == 1 ? 1 : -1;
    for (const auto& [nx, ny] : {std::pair{x + dx, y}, {x, y + dy}, {x + dx, y + dy}}) {
      const bool is_there = nx >= 0 && ny >= 0 && nx < width && ny < height;
      const auto own = at(x, y), other = is_there ? at(nx, ny) : own;
      const bool is_texture = of == Reason::kTexture || of == Reason::kSecondaryTexture;
      const std::uint32_t objects = is_texture ? own.object : own.object | other.object;
      if (focus && (objects & traces::kFocusObject) == 0) continue;
      if (disagrees(of, own, other)) found.insert(static_cast<std::uint32_t>(i));
    }
  }
  return found;
}

std::set<std::uint32_t> active(const TileResult& tile) {
  std::set<std::uint32_t> found;
  for (std::uint32_t i = 0; i < 4 * tile.width * tile.height; ++i) {
    if (active_bit<float>(tile.buffer.subpixels.verdicts[i]) == 1) found.insert(i);
  }
  return found;
}

const SupersampleWorld& room() {
  static const SupersampleWorld world(mirrored_room());
  return world;
}

class StrictAlone : public testing::TestWithParam<Reason> {};
INSTANTIATE_TEST_SUITE_P(Attributes, StrictAlone,
                         testing::Values(Reason::kObject, Reason::kNormal, Reason::kShadow, Reason::kTexture,
                                         Reason::kSecondaryObject, Reason::kSecondaryNormal, Reason::kSecondaryShadow,
                                         Reason::kSecondaryTexture),
                         [](const auto& i) {
                           return std::string(names_of(Attribute{})[static_cast<std::size_t>(i.param)]);
                         });

TEST_P(StrictAlone, AddsSamplesOnlyWhereItsAttributeDisagrees) {
  SupersampleConfig c = all_at(1);
  threshold(c, GetParam()) = 0;
  const Result result = room().supersample(whole_picture(), c);
  const std::set<std::uint32_t> expected = disagreeing(GetParam(), result.last, 66);
  EXPECT_EQ(active(result.last), expected);
  EXPECT_FALSE(expected.empty());
  EXPECT_EQ(result.sampling.reasons[static_cast<std::size_t>(GetParam())], expected.size());
}

TEST_P(StrictAlone, InFocusOnlyWhereAnObjectInFocusIsInvolved) {
  SupersampleConfig c = all_at(1);
  threshold(c, GetParam()) = 0;
  c.focus = true;
  const Result result = room().supersample(whole_picture(), c);
  const std::set<std::uint32_t> expected = disagreeing(GetParam(), result.last, 66, true);
  EXPECT_EQ(active(result.last), expected);
  EXPECT_FALSE(expected.empty());
  EXPECT_LT(expected.size(), disagreeing(GetParam(), result.last, 66).size());
}

TEST(StrictColour, AddsSamplesOnlyWhereNothingDisagrees) {
  SupersampleConfig c = all_at(1);
  c.colour = 0;
  const Result result = room().supersample(whole_picture(), c);
  std::set<std::uint32_t> others;
  for (std::size_t i = 1; i < kAttributes; ++i) others.merge(disagreeing(static_cast<Reason>(i), result.last, 66));
  const std::set<std::uint32_t> found = active(result.last);
  EXPECT_EQ(found.size() + others.size(), 4U * 64U * 48U);
  for (const std::uint32_t subpixel : found) EXPECT_FALSE(others.contains(subpixel)) << subpixel;
  EXPECT_EQ(result.sampling.reasons[0], found.size());
}

TEST(Off, LeavesAPixelToTheOtherAttributes) {
  SupersampleConfig strict = all_at(1);
  strict.colour = 0;
  SupersampleConfig off = strict;
  off.texture = off.secondary_texture = -1;
  const std::uint64_t with = room().supersample(whole_picture(), strict).sampling.traced;
  EXPECT_GT(room().supersample(whole_picture(), off).sampling.traced, with);
  // If all others are off, the colour decides everywhere; with the colour off too, nothing is active.
  SupersampleConfig colour_alone = all_at(-1);
  colour_alone.colour = 0;
  EXPECT_EQ(room().supersample(whole_picture(), colour_alone).sampling.active[4], 64U * 48U);
  EXPECT_EQ(room().supersample(whole_picture(), all_at(-1)).sampling.active[0], 64U * 48U);
}

TEST(Branches, TheStrongerBranchIsKept) {
  // A pane of glass, seen head-on, reflects 4 %, so the wall seen through it decides, not the reflected one.
  traces::Scene scene;
  const std::uint32_t glass = traces::add_material(scene, {.name = "glass", .transmission = 1});
  const std::uint32_t grey = traces::add_material(scene, {.name = "grey"});
  traces::add_object(scene, traces::make_quad("pane", {-9, -9, 0}, {18, 0, 0}, {0, 18, 0}, 1), glass);
  traces::add_object(scene, traces::make_quad("behind pane", {-9, -9, -3}, {18, 0, 0}, {0, 18, 0}, 1), grey);
  traces::add_object(scene, traces::make_quad("behind eye", {-9, -9, 6}, {18, 0, 0}, {0, 18, 0}, 1), grey);
  scene.cameras.push_back(traces::look_at("front", {0, 0, 4}, {0, 0, 0}, 0.5F));
  RenderConfig render = small(8, 8);
  const Result through = SupersampleWorld(scene).supersample(render, {});
  EXPECT_EQ(through.last.buffer.subpixels.secondary_traits[5 * 18 + 5].object, 1U);
  EXPECT_EQ(through.last.buffer.subpixels.traits[5 * 18 + 5].object, 0U);
  scene.materials[glass].transmission = 0.1F;
  scene.materials[glass].mirror = 0.8F;
  EXPECT_EQ(SupersampleWorld(scene).supersample(render, {}).last.buffer.subpixels.secondary_traits[5 * 18 + 5].object,
            2U);
  // If the heavier branch hits nothing there is no secondary hit, whatever the lighter one hits.
  scene.instances.pop_back();
  EXPECT_EQ(SupersampleWorld(scene).supersample(render, {}).last.buffer.subpixels.secondary_traits[5 * 18 + 5].object,
            kNoObject);
}

}  // namespace
}  // namespace kernels
