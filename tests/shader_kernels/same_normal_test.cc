#include <gtest/gtest.h>

#include "harness.h"
#include "shader_kernels/kernels/test_subpixels.h"
#include "shader_kernels/programs/adaptive/supersample.h"

// Jin's preset value: the dot product from which on two normals are the same.

namespace kernels {
namespace {

TEST(SameNormal, IsTheLeastDotProductOfNormalsThatDoNotDiffer) {
  const TraitsRecord<float> one{{0, 0, 1}, 1, 0}, other{{0.6F, 0, 0.8F}, 1, 0};
  EXPECT_EQ(disagreements<float>(one, other, 0.9F, 0), 2U);
  EXPECT_EQ(disagreements<float>(one, other, 0.8F, 0), 0U);
  EXPECT_EQ(disagreements<float>(one, one, 1, 0), 0U);
  EXPECT_EQ(disagreements<float>(one, one, 2, 0), 2U) << "nothing reaches it";
}

TEST(SameNormal, DecidesWhereSupersampleFindsNormalsToDiffer) {
  const traces::Scene scene = traces::open_scene("teapot");
  const traces::MemoryImage image = traces::build_memory_image(scene);
  const traces::BvhTracer tracer(image);
  SupersampleConfig c;
  c.colour = c.object = c.shadow = c.texture = 1;
  c.secondary_object = c.secondary_normal = c.secondary_shadow = c.secondary_texture = 1;
  c.normal = 0;
  const auto active = [&](double same_normal) {
    c.same_normal = same_normal;
    SupersampleProgram program(image, scene.cameras.front(), small(24, 16), c, 0);
    run_tiles(program, tracer, false, [](const TileResult&) {});
    return 24U * 16U - program.sampling().active[0];
  };
  EXPECT_EQ(active(-1), 0U);
  EXPECT_GT(active(0.9), active(0.5));
  EXPECT_GT(active(0.5), 0U);
  EXPECT_EQ(active(2), 24U * 16U);
}

}  // namespace
}  // namespace kernels
