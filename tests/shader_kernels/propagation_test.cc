#include <array>
#include <cmath>
#include <numeric>
#include <vector>

#include <gtest/gtest.h>

#include "harness.h"
#include "shader_kernels/kernels/subpixels.h"
#include "shader_kernels/programs/adaptive/supersample.h"

// Tests of propagation in `supersample`: a sub-pixel that differs from an active neighbour is sampled, too.

namespace kernels {
namespace {

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
