#include "shader_kernels/programs/adaptive/supersample.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <set>
#include <vector>

#include <gtest/gtest.h>

#include "harness.h"
#include "shader_kernels/kernels/subpixels.h"
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

// Tests of propagation in `supersample`: a sub-pixel that differs from an active neighbour is sampled, too.

struct Propagated {
  std::vector<float> rgb;
  Sampling sampling;
  std::vector<SampleMark> marks;
  std::vector<traces::TileWork> works;
};

/// Returns a scene of slanted bars, a third of a pixel wide, in front of a wall. Only some pixel centres hit a bar.
traces::Scene bars() {
  traces::Scene scene = empty_scene();
  add_wall(scene, -1, 20, {.base_colour = glm::vec3(0), .emission = {0, 0, 0.5F}});
  const std::uint32_t wood = traces::add_material(scene, {.base_colour = glm::vec3(0), .emission = {0.5F, 0.4F, 0}});
  for (int i = -3; i <= 3; ++i) {
    const float x = 0.26F * static_cast<float>(i);
    traces::add_object(scene, traces::make_quad("bar", {x, -1.2F, 0}, {0.014F, 0, 0}, {0.31F, 2.4F, 0}, 1), wood);
  }
  scene.cameras.push_back(traces::look_at("c", {0, 0, 4}, {0, 0, 0}, 0.5F));
  return scene;
}

struct PropagationWorld {
  explicit PropagationWorld(const traces::Scene& scene)
      : image(traces::build_memory_image(scene)), tracer(image), camera(scene.cameras[0]) {}
  Propagated run(const RenderConfig& render, const SupersampleConfig& c, bool record = false) const {
    SupersampleProgram program(image, camera, render, c, 0);
    program.enable_marks();
    Propagated out;
    run_tiles(program, tracer, record, [&](const TileResult& tile) {
      if (record) out.works.push_back(tile.work);
    });
    out.rgb = program.picture();
    out.sampling = program.sampling();
    out.marks = program.sample_marks();
    return out;
  }
  std::vector<float> full(RenderConfig render, std::uint32_t samples) const {
    render.samples = samples == 1 ? SamplePattern::kRegular : SamplePattern::kJittered;
    return kernels::render(image, camera, tracer, render, samples).rgb;
  }
  const traces::MemoryImage image;
  const traces::BvhTracer tracer;
  const traces::Camera camera;
};

SupersampleConfig rounds(std::uint32_t count) {
  SupersampleConfig c;
  c.propagate = count;
  return c;
}
SupersampleConfig all_at(double value, std::uint32_t count) {
  SupersampleConfig c = rounds(count);
  c.colour = c.object = c.normal = c.shadow = c.texture = value;
  c.secondary_object = c.secondary_normal = c.secondary_shadow = c.secondary_texture = value;
  return c;
}

double squared_error(const std::vector<float>& a, const std::vector<float>& b) {
  return std::transform_reduce(a.begin(), a.end(), b.begin(), 0.0, std::plus<>(),
                               [](double x, double y) { return (x - y) * (x - y); });
}

TEST(Propagation, FollowsBarsThinnerThanAPixel) {
  const PropagationWorld world(bars());
  const RenderConfig render = small(64, 48);
  const std::vector<float> truth = world.full(render, 16);
  double before = squared_error(world.run(render, rounds(0)).rgb, truth);
  ASSERT_GT(before, 0);
  std::uint64_t found = 0;
  for (const std::uint32_t count : {1U, 2U, 4U}) {
    const Propagated run = world.run(render, rounds(count));
    const double error = squared_error(run.rgb, truth);
    EXPECT_LT(error, before) << count << " rounds";
    EXPECT_GT(run.sampling.propagated, found);
    before = error;
    found = run.sampling.propagated;
  }
  EXPECT_LT(before, 0.5 * squared_error(world.run(render, rounds(0)).rgb, truth));
}

TEST(Propagation, CountsAndMarksTracedSubpixels) {
  const PropagationWorld world(bars());
  const RenderConfig render = small(64, 48);
  const Propagated once = world.run(render, rounds(0)), with = world.run(render, rounds(4));
  EXPECT_GT(with.sampling.propagated, 0U);
  EXPECT_EQ(with.sampling.correction, 4 * with.sampling.propagated);
  EXPECT_EQ(with.sampling.traced, once.sampling.traced + with.sampling.correction);
  EXPECT_EQ(with.sampling.wanted, once.sampling.wanted);
  EXPECT_EQ(with.sampling.reasons, once.sampling.reasons) << "of the first test";
  std::array<std::uint64_t, 5> marked{};
  std::uint64_t subpixels = 0;
  for (std::size_t i = 0; i < with.marks.size(); ++i) {
    const std::uint32_t active = active_subpixel_count(with.marks[i]), first = active_subpixel_count(once.marks[i]);
    marked.at(active) += 1;
    subpixels += active - first;
    EXPECT_EQ((with.marks[i] & kCorrectedMark) != 0, active > first);
    const bool is_changed = !std::equal(&with.rgb[3 * i], &with.rgb[3 * i] + 3, &once.rgb[3 * i]);
    EXPECT_TRUE(!is_changed || active > first) << "a pixel that has not been corrected keeps its bits";
  }
  EXPECT_EQ(marked, with.sampling.active);
  EXPECT_EQ(subpixels, with.sampling.propagated);
}

TEST(Propagation, HasNothingToDoIfAllOrNoSubpixelsAreActive) {
  const PropagationWorld world(bars());
  const RenderConfig render = small(37, 29);
  EXPECT_EQ(world.run(render, all_at(0, 4)).rgb, world.full(render, 16));
  EXPECT_EQ(world.run(render, all_at(0, 4)).sampling.propagated, 0U);
  EXPECT_EQ(world.run(render, all_at(1, 4)).rgb, world.full(render, 1));
  EXPECT_EQ(world.run(render, all_at(-1, 4)).sampling.propagated, 0U);
}

TEST(Propagation, ThePictureIsTheSameForEveryTileHaloAttributeStoragePackingAndStream) {
  for (const traces::Scene& scene : {bars(), traces::open_scene("cornell")}) {
    const PropagationWorld world(scene);
    for (const SubpixelFilter filter : {SubpixelFilter::kNearest, SubpixelFilter::kBilinear}) {
      SupersampleConfig c = rounds(3);
      c.filter = filter;
      RenderConfig render = small(37, 29);
      const Propagated reference = world.run(render, c);
      EXPECT_GT(reference.sampling.propagated, 0U);
      for (const std::uint32_t tile : {1U, 8U, 24U, 128U}) {
        for (const Packing packing : {Packing::kBlock, Packing::kAtomic, Packing::kNone}) {
          c.packing = packing;
          c.halo = packing == Packing::kNone ? Halo::kRetrace : Halo::kReload;
          c.attributes = packing == Packing::kAtomic ? AttributeStorage::kDram : AttributeStorage::kTile;
          render.tile = tile;
          render.streams = tile == 24 ? Streams::kDivergent : Streams::kCompacted;
          const Propagated run = world.run(render, c, true);
          EXPECT_EQ(run.rgb, reference.rgb) << "tile " << tile;
          EXPECT_EQ(run.marks, reference.marks);
          EXPECT_EQ(run.sampling.active, reference.sampling.active);
          EXPECT_EQ(run.sampling.propagated, reference.sampling.propagated);
          EXPECT_EQ(run.sampling.background, reference.sampling.background);
          EXPECT_EQ(run.sampling.traced - run.sampling.halo, reference.sampling.traced - reference.sampling.halo);
        }
      }
    }
  }
}

TEST(Propagation, ARoundReadsNothingInTilesWithoutActiveNeighbours) {
  const PropagationWorld world(bars());
  const RenderConfig render = small(64, 48);
  const SupersampleConfig c = rounds(2);
  SupersampleProgram program(world.image, world.camera, render, c, 0);
  const std::uint32_t count = program.pass_end(0);
  EXPECT_EQ(program.tiles(), 3 * count);
  EXPECT_EQ(SupersampleProgram(world.image, world.camera, render, rounds(0), 0).tiles(), count);
  const auto samples = static_cast<std::size_t>(traces::Region::kSamples);
  std::uint32_t idle = 0, busy = 0;
  const Propagated run = world.run(render, c, true);
  for (std::size_t entry = 0; entry < run.works.size(); ++entry) {
    const traces::TileWork& work = run.works[entry];
    EXPECT_EQ(work.after_all, entry != 0 && entry % count == 0);
    bool launches = false;
    for (const traces::WorkNode& node : work.nodes) {
      launches |= node.kind == traces::WorkNode::Kind::kLaunch;
      if (node.kind != traces::WorkNode::Kind::kTransfer) continue;
      EXPECT_LE(node.offset + node.items, program.requirements().region_bytes[static_cast<std::size_t>(node.region)]);
      if (entry >= count && !launches) {
        EXPECT_EQ(static_cast<std::size_t>(node.region), samples);
      }
    }
    if (entry >= count) (launches ? busy : idle) += 1;
  }
  EXPECT_GT(idle, 0U);
  EXPECT_GT(busy, 0U);
}

/// Returns the sub-pixels of 2 x 2 pixels that one round makes active. Colours are encoded grey values. Sub-pixels are
/// active for `reasons` since round `made`, if that is not 0.
std::vector<std::uint32_t> found(const std::array<float, 16>& greys, const std::array<std::uint32_t, 16>& made,
                                 Attribute reason, double threshold) {
  std::vector<SubpixelRecord<float>> states(36);
  for (std::uint32_t i = 0; i < 16; ++i) {
    const std::uint32_t grey = static_cast<std::uint32_t>(greys[i] * 65535);
    const std::uint32_t why = made[i] << kRoundShift | (made[i] != 0 ? attribute_bit(reason) << kReasonsShift : 0U);
    states[(i / 4 + 1) * 6 + i % 4 + 1] = {grey | grey << 16, grey | why};
  }
  std::array<std::uint32_t, 17> verdicts{}, active{}, masters{};
  PropagateSubpixels::Ports<float> ports;
  ports.grid = {2, 0.5F, 7, 6};
  ports.states.bind(states.data());
  ports.verdicts.bind(verdicts.data());
  ports.active.bind(active.data());
  ports.masters.bind(masters.data());
  ports.last_master.value = -1;
  ports.thresholds.fill(kNever);
  ports.thresholds[static_cast<std::size_t>(reason)] = static_cast<float>(threshold);
  ports.round = 1U << kRoundShift;
  for (std::uint32_t i = 0; i < 16; ++i) PropagateSubpixels::body<float>(i, ports);
  std::vector<std::uint32_t> out;
  for (std::uint32_t i = 0; i < ports.active_count.value; ++i) {
    const std::uint32_t subpixel = active[i], pixel = subpixel / 4;
    out.push_back((2 * (pixel / 2) + subpixel / 2 % 2) * 4 + 2 * (pixel % 2) + subpixel % 2);  // row by row
    EXPECT_EQ(verdicts[subpixel], attribute_bit(reason)) << "it has its neighbour's reasons";
  }
  std::vector<std::uint32_t> pixels;
  for (std::uint32_t i = 0; i < ports.active_count.value; ++i) {
    if (pixels.empty() || pixels.back() != active[i] / 4) pixels.push_back(active[i] / 4);
  }
  EXPECT_EQ(std::vector(masters.begin(), masters.begin() + ports.masters_count.value), pixels);
  return out;
}

TEST(PropagateSubpixelsKernel, FindsNeighboursThatDifferFromTheLastActiveSubpixels) {
  std::array<float, 16> greys;
  greys.fill(0.5F);
  greys[5] = 0.6F;
  std::array<std::uint32_t, 16> made{};
  made[5] = 1;
  using Found = std::vector<std::uint32_t>;
  // A contrast of 0.0909 is above 1.02 x 0.08, the threshold of the channel with the least factor, but not above 1.02 x
  // 0.1.
  Found four = found(greys, made, Attribute::kObject, 0.08);
  std::ranges::sort(four);
  EXPECT_EQ(four, (Found{1, 4, 6, 9}));
  EXPECT_EQ(found(greys, made, Attribute::kObject, 0.1), Found{});
  EXPECT_EQ(found(greys, made, Attribute::kColour, 1), Found{});
  made[5] = 2;
  EXPECT_EQ(found(greys, made, Attribute::kObject, 0.01), Found{}) << "another round's";
  made[5] = 1;
  made[6] = 3;
  greys[9] = 0.6F;
  four = found(greys, made, Attribute::kObject, 0.08);
  std::ranges::sort(four);
  EXPECT_EQ(four, (Found{1, 4})) << "active already; alike";
  greys.fill(0.5F);
  EXPECT_EQ(found(greys, made, Attribute::kObject, 0), Found{}) << "what is equal does not differ";
}

}  // namespace
}  // namespace kernels
