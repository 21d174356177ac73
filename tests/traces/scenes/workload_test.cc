#include "traces/scenes/workload.h"

#include <gtest/gtest.h>

#include "sim/error.h"
#include "traces/scene/bounds.h"
#include "traces/scene/lights.h"
#include "traces/scenes/builtin.h"

namespace {

using traces::LightRig;
using traces::Scene;
using traces::WorkloadConfig;

WorkloadConfig of(const char* name) {
  WorkloadConfig workload;
  workload.name = name;
  workload.triangles = 5000;
  return workload;
}

TEST(Workload, IsTheSceneUnlessItSaysMore) {
  const Scene plain = traces::build_scene("atrium", {.triangles = 5000});
  const Scene scene = traces::open_workload(of("atrium"));
  EXPECT_EQ(scene.sha256, plain.sha256);
  EXPECT_EQ(scene.lights.size(), plain.lights.size());
  EXPECT_EQ(scene.background, plain.background);
  EXPECT_EQ(scene.ambient, plain.ambient);
  ASSERT_EQ(scene.cameras.size(), 1U);
  EXPECT_EQ(scene.cameras[0].to_world, plain.cameras[0].to_world);
}

TEST(Workload, KeepsOneLightOrBringsItsOwn) {
  WorkloadConfig workload = of("conference");
  ASSERT_GT(traces::open_workload(workload).lights.size(), 1U);
  workload.lights.rig = LightRig::kStrongest;
  EXPECT_EQ(traces::open_workload(workload).lights.size(), 1U);

  workload.lights.rig = LightRig::kPoint;
  workload.lights.position = {1, 2, 3};
  Scene scene = traces::open_workload(workload);
  ASSERT_EQ(scene.lights.size(), 1U);
  EXPECT_EQ(scene.lights[0].kind, traces::Light::Kind::kPoint);
  EXPECT_EQ(scene.lights[0].position, glm::vec3(1, 2, 3));

  workload.lights.rig = LightRig::kSun;
  workload.lights.direction = {0, -2, 0};
  workload.lights.intensity = {0.5, 0.25, 0};
  scene = traces::open_workload(workload);
  ASSERT_EQ(scene.lights.size(), 1U);
  EXPECT_EQ(scene.lights[0].kind, traces::Light::Kind::kDirectional);
  EXPECT_EQ(scene.lights[0].direction, glm::vec3(0, -1, 0));
  EXPECT_EQ(scene.lights[0].intensity, glm::vec3(0.5F, 0.25F, 0));
}

TEST(Workload, TheStrongestLightIsTheOneThatLightsTheView) {
  Scene scene = traces::build_scene("teapot", {.triangles = 5000});
  traces::Light far = scene.lights[0];
  far.position *= 1000.0F;
  far.intensity *= 2.0F;
  scene.lights.insert(scene.lights.begin(), far);
  const glm::vec3 near_one = scene.lights[1].position;
  traces::keep_strongest_light(scene);
  ASSERT_EQ(scene.lights.size(), 1U);
  EXPECT_EQ(scene.lights[0].position, near_one);
}

TEST(Workload, HasASkyOfItsOwn) {
  WorkloadConfig workload = of("teapot");
  workload.sky = {traces::Sky::kOwn, {0.1, 0.2, 0.3}, {0.4, 0.5, 0.6}};
  const Scene scene = traces::open_workload(workload);
  EXPECT_EQ(scene.background, glm::vec3(0.1F, 0.2F, 0.3F));
  EXPECT_EQ(scene.ambient, glm::vec3(0.4F, 0.5F, 0.6F));
}

TEST(Workload, CameraGoesRoundTheSceneAtItsDistanceAndHeight) {
  WorkloadConfig workload = of("teapot");
  workload.camera_path = traces::CameraPath::kOrbit;
  workload.orbit = 90;
  workload.frame_rate = 1;
  Scene scene = traces::open_workload(workload);
  const glm::vec3 centre = traces::world_bounds(scene).centre();
  const glm::vec3 start = glm::vec3(scene.cameras[0].to_world[3]) - centre;
  for (const std::uint32_t frame : {3U, 1U}) {  // in any order
    EXPECT_TRUE(traces::pose_workload(scene, workload, frame).view);
    const glm::vec3 now = glm::vec3(scene.cameras[0].to_world[3]) - centre;
    const float turn = frame == 1 ? 1.0F : -1.0F;
    EXPECT_NEAR(now.x, turn * start.z, 1e-4F);
    EXPECT_NEAR(now.z, -turn * start.x, 1e-4F);
    EXPECT_FLOAT_EQ(now.y, start.y);
  }
  EXPECT_TRUE(traces::pose_workload(scene, workload, 4).view);
  EXPECT_NEAR(glm::distance(glm::vec3(scene.cameras[0].to_world[3]) - centre, start), 0, 1e-4F) << "once round";
}

TEST(Workload, FirstFrameSetsTheTime) {
  WorkloadConfig workload = of("car");
  const Scene start = traces::open_workload(workload);
  workload.first_frame = workload.last_frame = 30;
  const Scene later = traces::open_workload(workload);
  const auto moved = [&] {
    std::size_t count = 0;
    for (std::size_t i = 0; i < start.instances.size(); ++i) {
      count += start.instances[i].to_world == later.instances[i].to_world ? 0U : 1U;
    }
    return count;
  };
  EXPECT_GT(moved(), 4U) << "body and wheels";
  EXPECT_LT(moved(), start.instances.size()) << "the hall stands still";
}

TEST(Workload, NamesTheCamerasThatThereAre) {
  WorkloadConfig workload = of("conference");
  workload.camera = "conrer";
  try {
    traces::open_workload(workload);
    FAIL();
  } catch (const sim::InputError& error) {
    EXPECT_NE(std::string(error.what()).find("did you mean 'corner'"), std::string::npos) << error.what();
  }
}

}  // namespace
