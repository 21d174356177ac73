#include "traces/raster/rasteriser.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include <gtest/gtest.h>

#include "sim/hash.h"
#include "tests/traces/raster/support.h"

namespace traces {
namespace {

constexpr float kAway = -1;

/// Returns a square from (x0, y0) to (x1, y1), in fractions of the picture's height, at `depth` in front of
/// straight_ahead().
std::vector<std::array<glm::vec3, 3>> square(float x0, float y0, float x1, float y1, float depth = 1) {
  const auto at = [&](float x, float y) { return glm::vec3((x - 0.5F) * depth, (0.5F - y) * depth, kAway * depth); };
  return {{at(x0, y0), at(x1, y0), at(x1, y1)}, {at(x0, y0), at(x1, y1), at(x0, y1)}};
}

void append(std::vector<std::array<glm::vec3, 3>>& all, const std::vector<std::array<glm::vec3, 3>>& more) {
  all.insert(all.end(), more.begin(), more.end());
}

struct Seen {
  Coverage found;
  TileWork work;
};

Seen cover(const Rasteriser& rasteriser, const std::vector<Ray>& rays) {
  Seen seen;
  rasteriser.rasterise_samples(rays, seen.found, &seen.work);
  return seen;
}

TEST(Rasteriser, CoversASquareOfTwoTrianglesOnceWithSamplesOnTheirCommonEdge) {
  const PictureCamera camera = straight_ahead(16, 16);
  const Rasteriser rasteriser(image_of(square(0.25F, 0.25F, 0.75F, 0.75F)), camera, {}, 16);
  const Seen seen = cover(rasteriser, rays_of(camera, 0, 0, 16, 16));
  // 8 x 8 pixels; the centres of eight are on the diagonal.
  EXPECT_EQ(std::accumulate(seen.found.layers.begin(), seen.found.layers.end(), 0U), 64U);
  EXPECT_EQ(*std::ranges::max_element(seen.found.layers), 1U);
}

TEST(Rasteriser, GivesSamplesOnAnEdgeToTheTriangleRightOfItOrBelow) {
  const PictureCamera camera = straight_ahead(16, 16);
  std::vector<std::array<glm::vec3, 3>> both = square(0, 0, 0.5F, 1);
  append(both, square(0.5F, 0, 1, 1));
  const Rasteriser beside(image_of(both), camera, {}, 16);
  Coverage found;
  // In the middle of the picture the ray is along the axis and has no rounding.
  const std::vector<Ray> middle{{glm::vec3(0), 0, glm::vec3(0, 0, -1)}};
  beside.rasterise_samples(middle, found, nullptr);
  EXPECT_EQ(found.layers[0], 1U);
  EXPECT_GE(found.winners[0].triangle, 2U) << "the right one's";

  both = square(0, 0, 1, 0.5F);
  append(both, square(0, 0.5F, 1, 1));
  const Rasteriser stacked(image_of(both), camera, {}, 16);
  stacked.rasterise_samples(middle, found, nullptr);
  EXPECT_EQ(found.layers[0], 1U);
  EXPECT_GE(found.winners[0].triangle, 2U) << "the lower one's";
}

TEST(Rasteriser, CountsBlocksQuadsAndSamplesOfATriangleAsByHand) {
  const PictureCamera camera = straight_ahead(32, 32);
  std::vector<std::array<glm::vec3, 3>> all = square(0, 0, 4, 4);
  all.resize(1);  // its right angle is at the upper right corner; the upper left half of the picture is covered by
                  // others
  all[0] = {glm::vec3(-0.5F, 0.5F, -1), glm::vec3(1.5F, 0.5F, -1), glm::vec3(-0.5F, -1.5F, -1)};  // the whole picture
  const Rasteriser rasteriser(image_of(all), camera, {}, 32);
  const Seen seen = cover(rasteriser, rays_of(camera, 0, 0, 32, 32));
  ASSERT_EQ(seen.work.raster_triangles.size(), 1U);
  const RasterTriangle& t = seen.work.raster_triangles[0];
  EXPECT_EQ(t.blocks, 16U);
  EXPECT_EQ(t.quads, 256U);
  EXPECT_EQ(t.samples, 1024U);
  EXPECT_EQ(t.passed, 1024U);
  EXPECT_EQ(t.hidden_blocks + t.hidden_quads + t.hidden_samples, 0U);
  ASSERT_EQ(seen.work.raster.size(), 1U);
  EXPECT_EQ(seen.work.raster[0].pixel_samples, 1U);
}

TEST(Rasteriser, CountsFourSamplesOfAPixel) {
  const PictureCamera camera = straight_ahead(8, 8);
  const Rasteriser rasteriser(image_of(square(0, 0, 1, 1)), camera, {}, 8);
  const Seen seen = cover(rasteriser, rays_of(camera, 0, 0, 8, 8, 2));
  EXPECT_EQ(seen.work.raster.at(0).pixel_samples, 4U);
}

TEST(Rasteriser, LeavesOutBlocksThatAreFullOfNearerSurfaces) {
  const PictureCamera camera = straight_ahead(32, 32);
  std::vector<std::array<glm::vec3, 3>> all = square(0, 0, 1, 1, 1);
  append(all, square(0, 0, 1, 1, 2));  // farther away than the first square
  const Rasteriser rasteriser(image_of(all), camera, {}, 32);
  const Seen seen = cover(rasteriser, rays_of(camera, 0, 0, 32, 32));
  std::uint32_t hidden = 0, passed = 0;
  for (const RasterTriangle& t : seen.work.raster_triangles) {
    hidden += t.hidden_samples;
    passed += t.passed;
  }
  EXPECT_EQ(hidden, 1024U);
  EXPECT_EQ(passed, 1024U);
  for (const Coverage::NearestTriangle& winner : seen.found.winners) EXPECT_LT(winner.triangle, 2U);
}

TEST(Rasteriser, DrawsBothSidesOfATriangle) {
  const PictureCamera camera = straight_ahead(8, 8);
  std::vector<std::array<glm::vec3, 3>> all = square(0, 0, 1, 1);
  for (auto& t : all) std::swap(t[1], t[2]);
  const Rasteriser rasteriser(image_of(all), camera, {}, 8);
  const Seen seen = cover(rasteriser, rays_of(camera, 0, 0, 8, 8));
  EXPECT_TRUE(std::ranges::all_of(seen.found.layers, [](std::uint32_t n) { return n == 1; }));
}

TEST(Rasteriser, InterpolatesDepthInPerspective) {
  const PictureCamera camera = straight_ahead(64, 64);
  // A floor that extends away from the eye, 0.4 below it.
  const Rasteriser rasteriser(
      image_of({{glm::vec3(-50, -0.4F, 5), glm::vec3(50, -0.4F, 5), glm::vec3(0, -0.4F, -100)}}), camera, {}, 64);
  const std::vector<Ray> rays = rays_of(camera, 0, 0, 64, 64);
  const Seen seen = cover(rasteriser, rays);
  std::size_t hits = 0;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    if (seen.found.winners[i].triangle == kNone) continue;
    hits += 1;
    const double t = -0.4 / rays[i].direction.y;  // the ray's intersection with the plane
    EXPECT_NEAR(seen.found.winners[i].depth / (-rays[i].direction.z * t), 1, 1e-6);
  }
  EXPECT_GT(hits, 200U) << "the part before the eye is seen though a side of it lies behind";
}

TEST(Rasteriser, SurvivesTrianglesThatNoSceneShouldHave) {
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN(), kInf = std::numeric_limits<float>::infinity(),
                  kMax = std::numeric_limits<float>::max();
  const glm::vec3 a(-1, -1, -1), b(1, -1, -1), c(0, 1, -1);
  std::vector<std::array<glm::vec3, 3>> all = square(0, 0, 1, 1);
  append(all, {{glm::vec3(kNan), b, c},
               {a, glm::vec3(0, kNan, -1), c},
               {a, b, glm::vec3(kInf, 0, -1)},
               {a, b, glm::vec3(0, -kInf, 1)},
               {a, a, a},
               {a, b, b},
               {a, b, (a + b) * 0.5F},
               {glm::vec3(0), glm::vec3(0), glm::vec3(0)},
               {glm::vec3(0), b, c},                                             // a vertex at the eye
               {glm::vec3(-1, 0, 0), glm::vec3(1, 0, 0), glm::vec3(0, 0, -3)},   // seen edge-on
               {glm::vec3(-1, -1, 1), glm::vec3(1, -1, 1), glm::vec3(0, 1, 1)},  // behind the eye
               {glm::vec3(-kMax, -kMax, -kMax), glm::vec3(kMax, -kMax, -kMax), glm::vec3(0, kMax, -kMax)},
               {glm::vec3(-kMax, -1, 1), glm::vec3(kMax, -1, 1), glm::vec3(0, -1, -kMax)}});
  const PictureCamera camera = straight_ahead(32, 32);
  const Rasteriser rasteriser(image_of(all), camera, {.batch = 3}, 8);
  Seen seen;
  for (std::uint32_t batch = 0; batch < rasteriser.batch_count(); ++batch)
    rasteriser.bin_triangles(batch, seen.found, seen.work);
  ASSERT_EQ(seen.work.raster_triangles.size(), all.size());
  for (std::size_t t = 2; t < 10; ++t) EXPECT_EQ(seen.work.raster_triangles[t].lists, 0U) << t;
  EXPECT_EQ(seen.work.raster_triangles[12].lists, 0U) << "behind the eye";
  const std::vector<Ray> rays = rays_of(camera, 0, 0, 32, 32);
  rasteriser.rasterise_samples(rays, seen.found, nullptr);
  for (const Coverage::NearestTriangle& winner : seen.found.winners) {
    ASSERT_NE(winner.triangle, kNone) << "the square is behind all of them";
    EXPECT_TRUE(std::isfinite(winner.depth));
    EXPECT_GT(winner.depth, 0);
  }
}

TEST(Rasteriser, SurvivesARandomMessOfBits) {
  std::vector<std::array<glm::vec3, 3>> all;
  std::uint64_t n = 0;
  const auto number = [&] {
    const auto bits = static_cast<std::uint32_t>(sim::hash(7, n++));
    return n % 3 == 0 ? std::bit_cast<float>(bits) : 4 * sim::hash_to_unit_float(bits) - 2;
  };
  for (int i = 0; i < 500; ++i) {
    auto& t = all.emplace_back();
    for (glm::vec3& p : t) p = {number(), number(), number()};
  }
  const PictureCamera camera = straight_ahead(24, 16);
  const Rasteriser rasteriser(image_of(all), camera, {.batch = 100, .block = 4}, 5);
  Seen seen = cover(rasteriser, rays_of(camera, 0, 0, 24, 16, 2));
  std::uint64_t covered = 0, passed = 0;
  for (const RasterTriangle& t : seen.work.raster_triangles) {
    EXPECT_LE(t.hidden_quads, t.quads);
    EXPECT_LE(t.passed, t.samples - t.hidden_samples);
    EXPECT_LE(t.quads, t.samples);
    covered += t.samples;
    passed += t.passed;
  }
  EXPECT_EQ(covered, std::accumulate(seen.found.layers.begin(), seen.found.layers.end(), std::uint64_t{0}));
  EXPECT_GE(passed, static_cast<std::uint64_t>(std::ranges::count_if(
                        seen.found.winners, [](const Coverage::NearestTriangle& w) { return w.triangle != kNone; })));
}

TEST(Rasteriser, HasEveryEntryOfItsListsInOneBatchesRuns) {
  std::vector<std::array<glm::vec3, 3>> all;
  for (std::uint64_t i = 0; i < 300; ++i) {
    const float x = sim::hash_to_unit_float(sim::hash(1, i)), y = sim::hash_to_unit_float(sim::hash(2, i));
    append(all, square(x, y, x + 0.1F, y + 0.05F, 1 + x));
  }
  const PictureCamera camera = straight_ahead(64, 64);
  const Rasteriser rasteriser(image_of(all), camera, {.batch = 64}, 16);
  EXPECT_EQ(rasteriser.batch_count(), 10U);
  std::vector<int> written(rasteriser.raster_array_sizes().entries);
  std::uint64_t listed = 0;
  for (std::uint32_t batch = 0; batch < rasteriser.batch_count(); ++batch) {
    Seen seen;
    EXPECT_EQ(rasteriser.bin_triangles(batch, seen.found, seen.work), batch < 9 ? 64U : 24U);
    for (const ListRun& run : seen.work.list_runs) {
      for (std::uint32_t e = run.first; e < run.first + run.entries; ++e) written.at(e) += 1;
    }
    for (const RasterTriangle& t : seen.work.raster_triangles) listed += t.lists;
  }
  EXPECT_TRUE(std::ranges::all_of(written, [](int times) { return times == 1; }));
  EXPECT_EQ(listed, written.size());
}

TEST(Rasteriser, FindsTheSameInAnyListsAndBlocks) {
  std::vector<std::array<glm::vec3, 3>> all;
  for (std::uint64_t i = 0; i < 200; ++i) {
    const float x = sim::hash_to_unit_float(sim::hash(3, i)), y = sim::hash_to_unit_float(sim::hash(4, i));
    append(all, square(x - 0.2F, y - 0.2F, x + 0.2F, y, 1 + 3 * sim::hash_to_unit_float(sim::hash(5, i))));
  }
  const PictureCamera camera = straight_ahead(40, 30);
  const std::vector<Ray> rays = rays_of(camera, 0, 0, 40, 30);
  const Seen whole = cover(Rasteriser(image_of(all), camera, {.batch = 7, .block = 64}, 64), rays);
  const Seen cut = cover(Rasteriser(image_of(all), camera, {.block = 2}, 3), rays);
  for (std::size_t i = 0; i < rays.size(); ++i) {
    EXPECT_EQ(whole.found.winners[i].triangle, cut.found.winners[i].triangle);
    EXPECT_EQ(whole.found.winners[i].depth, cut.found.winners[i].depth);
    EXPECT_EQ(whole.found.layers[i], cut.found.layers[i]);
  }
}

TEST(RasterGeometry, SharesVerticesOfTheSamePosition) {
  const RasterGeometry geometry = raster_geometry(image_of(square(0, 0, 1, 1)));
  EXPECT_EQ(geometry.vertices.size(), 4U);
  ASSERT_EQ(geometry.triangles.size(), 2U);
  EXPECT_EQ(geometry.triangles[0].vertices, (std::array{0U, 1U, 2U}));
  EXPECT_EQ(geometry.triangles[1].vertices, (std::array{0U, 2U, 3U}));
}

}  // namespace
}  // namespace traces
