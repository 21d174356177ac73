#include <array>
#include <cstdint>
#include <vector>

#include <gtest/gtest.h>

#include "hw_models/machines/ray_machine.h"
#include "traces/accel/build.h"
#include "traces/scenes/library.h"

// Tests of a core's share of a list of rays, whose blocks are kept until all their rays have returned.

namespace hw {
namespace {

constexpr std::uint32_t kBlock = CoreRays::kBlock;

class CoreRaysTest : public testing::Test {
 protected:
  /// Returns rays that go down, spread over the whole scene.
  static std::vector<traces::Ray> rays(const traces::MemoryImage& image, std::uint32_t count) {
    std::vector<traces::Ray> list(count);
    for (std::uint32_t i = 0; i < count; ++i) {
      const glm::vec3 sides = image.upper - image.lower;
      list[i].origin = image.lower + sides * glm::vec3(static_cast<float>(i) / static_cast<float>(count), 1, 0.5F);
      list[i].direction = {0, -1, 0};
    }
    return list;
  }

  const traces::MemoryImage image_ = traces::build_memory_image(traces::open_scene("cornell"), {}, 1);
  const traces::BvhTracer tracer_{image_};
};

TEST_F(CoreRaysTest, ABlockIsDroppedWhenTheLastOfItsRaysReturns) {
  const std::vector<traces::Ray> list = rays(image_, 2 * kBlock + 8);
  std::vector<std::uint32_t> finished;
  CoreRays core(list, traces::RayKind::kPrimary, tracer_, {image_.lower, image_.upper}, 0, 1,
                [&](std::uint32_t count, sim::Time) {
                  finished.push_back(count);
                  return true;
                });
  ASSERT_EQ(core.ray_count(), list.size());
  std::vector<std::vector<std::uint32_t>> walks;
  for (std::uint32_t ray = 0; ray < core.ray_count(); ++ray)
    walks.push_back({*core.ray_walk(ray), *(core.ray_walk(ray) + 1)});
  for (std::uint32_t ray = 1; ray < core.ray_count(); ++ray) core.record_return_time(ray, 0);
  EXPECT_TRUE(finished.empty()) << "the first ray is out, and blocks are forgotten in their order";
  EXPECT_EQ(*core.ray_walk(0), walks[0][0]);
  EXPECT_EQ(*core.ray_walk(2 * kBlock), walks[2 * kBlock][0]);
  core.record_return_time(0, 0);
  EXPECT_EQ(finished, (std::vector<std::uint32_t>{kBlock, kBlock, 8}));
}

TEST_F(CoreRaysTest, CoresTakeBlocksInTurnAndStopOnRequest) {
  const std::vector<traces::Ray> list = rays(image_, 5 * kBlock);
  std::uint32_t finished = 0;
  CoreRays core(list, traces::RayKind::kPrimary, tracer_, {image_.lower, image_.upper}, 1, 2,
                [&](std::uint32_t, sim::Time) { return ++finished < 1; });
  ASSERT_EQ(core.ray_count(), 2 * kBlock) << "the second and the fourth block";
  for (std::uint32_t ray = 0; ray < kBlock; ++ray) {
    core.ray_walk(ray);
    core.record_return_time(ray, 0);
  }
  EXPECT_EQ(finished, 1U);
  EXPECT_EQ(core.ray_count(), kBlock) << "no other block had been traced";
}

}  // namespace
}  // namespace hw
