#include <cmath>
#include <string>

#include <gtest/gtest.h>

#include "tests/traces/raster/support.h"
#include "traces/accel/bvh_tracer.h"
#include "traces/scenes/library.h"

// A rasteriser and the canonical tracer find the same triangle at every sample, but for those on an edge to within
// rounding, and the same depth.

namespace traces {
namespace {

struct Agreement {
  std::uint64_t samples = 0, hits = 0;
  std::uint64_t ties = 0;   ///< other triangles at the same depth: surfaces, or edges, that meet there
  std::uint64_t edges = 0;  ///< one of both found a triangle that the other missed, or a nearer one
  double worst_depth = 0;   ///< relative, where both found the same triangle
};

Agreement compare(const MemoryImage& image, const PictureCamera& camera) {
  constexpr std::uint32_t kSide = 32;
  const Rasteriser rasteriser(image, camera, {}, kSide);
  const BvhTracer tracer(image);
  Agreement all;
  Coverage found;
  for (std::uint32_t y = 0; y < camera.height; y += kSide) {
    for (std::uint32_t x = 0; x < camera.width; x += kSide) {
      const std::vector<Ray> rays = rays_of(camera, x, y, kSide, kSide);
      std::vector<Hit> hits(rays.size());
      tracer.trace(rays, RayKind::kPrimary, hits, nullptr);
      rasteriser.cover(rays, found, nullptr);
      for (std::size_t i = 0; i < rays.size(); ++i) {
        const Coverage::Winner& winner = found.winners[i];
        all.samples += 1;
        all.hits += hits[i].is_hit();
        if (!hits[i].is_hit() && winner.triangle == kNone) continue;
        if (!hits[i].is_hit() || winner.triangle == kNone) {
          all.edges += 1;
          continue;
        }
        const RasterGeometry::Triangle& triangle = rasteriser.geometry().triangles[winner.triangle];
        const double depth = rasteriser.view().of_ray(rays[i].direction).z * hits[i].t;
        const double apart = std::abs(winner.depth - depth) / depth;
        const bool same =
            triangle.index == hits[i].index() && (!image.has_levels() || triangle.instance == instance_of(hits[i]));
        if (same) {
          all.worst_depth = std::max(all.worst_depth, apart);
        } else {
          (apart < 1e-4 ? all.ties : all.edges) += 1;
        }
      }
    }
  }
  return all;
}

class RasterAgainstTracer : public testing::TestWithParam<const char*> {};

TEST_P(RasterAgainstTracer, FindsTheSameTriangleAndDepthAtEverySampleButEdges) {
  const Scene scene = open_scene(GetParam());
  const MemoryImage image = build_memory_image(scene, {}, 1);
  const Agreement found = compare(image, picture_of(scene.cameras.front(), 256, 128));
  RecordProperty("ties", std::to_string(found.ties));
  EXPECT_GT(found.hits, found.samples / 10);
  EXPECT_LE(found.edges, found.samples / 100'000 + 1);
  EXPECT_LT(found.worst_depth, 1e-4);
}
INSTANTIATE_TEST_SUITE_P(Scenes, RasterAgainstTracer,
                         testing::Values("cornell", "teapot", "conference", "atrium", "chess", "car"));

TEST(RasterAgainstTracer, AgreesInScenesOfTwoLevels) {
  const Scene scene = open_scene("forest");
  BvhConfig bvh;
  bvh.instances = InstanceLevels::kTwoLevel;
  const MemoryImage image = build_memory_image(scene, bvh, 1);
  ASSERT_TRUE(image.has_levels());
  const Agreement found = compare(image, picture_of(scene.cameras.front(), 256, 128));
  EXPECT_LE(found.edges, 4U);
  EXPECT_LT(found.worst_depth, 1e-4);
}

}  // namespace
}  // namespace traces
