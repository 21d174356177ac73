#include "traces/scenes/workload.h"

#include <fstream>

#include <gtest/gtest.h>

#include "sim/config/config.h"
#include "sim/error.h"
#include "tests/temp_folder.h"
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

TEST(Workload, UsesTheSceneAsItIsByDefault) {
  const Scene plain = traces::build_scene("atrium", {.triangles = 5000});
  const Scene scene = traces::open_workload(of("atrium"));
  EXPECT_EQ(scene.sha256, plain.sha256);
  EXPECT_EQ(scene.lights.size(), plain.lights.size());
  EXPECT_EQ(scene.background, plain.background);
  EXPECT_EQ(scene.ambient, plain.ambient);
  ASSERT_EQ(scene.cameras.size(), 1U);
  EXPECT_EQ(scene.cameras[0].to_world, plain.cameras[0].to_world);
}

TEST(Workload, ShowsBackFacesWithAWarningUnlessTheyAreCulled) {
  const test::TempFolder folder;
  const std::string file = (folder.path() / "scene.gltf").string();
  std::ofstream(file) << R"({"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}],
    "nodes": [{"mesh": 0}], "meshes": [{"primitives": [
      {"attributes": {"POSITION": 0}, "material": 0}, {"attributes": {"POSITION": 0}, "material": 1},
      {"attributes": {"POSITION": 0}, "material": 2}]}],
    "materials": [{"name": "one"}, {"name": "both", "doubleSided": true},
      {"name": "glass", "extensions": {"KHR_materials_transmission": {"transmissionFactor": 1}}}],
    "extensionsUsed": ["KHR_materials_transmission"],
    "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3",
                   "min": [0, 0, 0], "max": [1, 1, 0]}],
    "bufferViews": [{"buffer": 0, "byteLength": 36}],
    "buffers": [{"byteLength": 36, "uri":
      "data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA"}]})";
  WorkloadConfig workload;
  workload.name = file;
  const Scene shown = traces::open_workload(workload);
  EXPECT_TRUE(shown.materials[0].double_sided);
  ASSERT_EQ(shown.warnings.size(), 1U);
  EXPECT_EQ(shown.warnings[0],
            "1 of 3 materials have doubleSided: false, but their back faces are shown; scene.back_faces: culled hides "
            "them");
  workload.back_faces = traces::BackFaces::kCulled;
  const Scene culled = traces::open_workload(workload);
  EXPECT_FALSE(culled.materials[0].double_sided);
  EXPECT_TRUE(culled.materials[1].double_sided);
  EXPECT_TRUE(culled.warnings.empty());
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

TEST(Workload, HasAViewOfItsOwn) {
  WorkloadConfig workload = of("teapot");
  workload.view = {traces::ViewSource::kOwn, {1, 2, 3}, {1, 2, -5}, {2, 0, 0}, 90};
  const Scene scene = traces::open_workload(workload);
  ASSERT_EQ(scene.cameras.size(), 1U);
  const glm::mat4 wanted(glm::vec4(0, -1, 0, 0), glm::vec4(1, 0, 0, 0), glm::vec4(0, 0, 1, 0), glm::vec4(1, 2, 3, 1));
  EXPECT_EQ(scene.cameras[0].to_world, wanted) << "+x is up, so +y is to the left";
  EXPECT_FLOAT_EQ(scene.cameras[0].vertical_fov, 1.5707964F);
}

TEST(Workload, OwnViewGoesRoundTheSceneToo) {
  WorkloadConfig workload = of("teapot");
  workload.view = {traces::ViewSource::kOwn, {1, 2, 3}, {0, 0, 0}, {0, 1, 0}, 45};
  const glm::mat4 still = traces::open_workload(workload).cameras[0].to_world;
  workload.camera_path = traces::CameraPath::kOrbit;
  workload.orbit = 360;
  workload.frame_rate = 1;
  Scene scene = traces::open_workload(workload);
  traces::pose_workload(scene, workload, 1);
  for (int column = 0; column < 4; ++column) {
    EXPECT_NEAR(glm::distance(scene.cameras[0].to_world[column], still[column]), 0, 1e-4F);
  }
}

TEST(Workload, RefusesAViewWithoutADirection) {
  const auto complaint = [](const traces::ViewConfig& view, const char* camera = "") {
    WorkloadConfig workload = of("teapot");
    workload.view = view;
    workload.camera = camera;
    try {
      sim::check_config(workload);
    } catch (const sim::InputError& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  const auto own = traces::ViewSource::kOwn;
  EXPECT_EQ(complaint({own, {1, 2, 3}, {0, 0, 0}, {0, 1, 0}, 45}), "");
  EXPECT_EQ(complaint({own, {1, 2, 3}, {1, 2, 3}, {0, 1, 0}, 45}),
            "view.target: is the camera's position; allowed: any other point");
  EXPECT_EQ(complaint({own, {0, 5, 0}, {0, 0, 0}, {0, 2, 0}, 45}),
            "view.up: lies along the view, or is 0 0 0; allowed: any other direction");
  EXPECT_EQ(complaint({own, {1, 2, 3}, {0, 0, 0}, {0, 1, 0}, 45}, "front"),
            "camera: names one of the scene's, and view.source is own; allowed: one of the two");
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

TEST(Workload, ListsTheCamerasForAnUnknownName) {
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
