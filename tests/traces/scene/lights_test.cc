#include "traces/scene/lights.h"

#include <gtest/gtest.h>

#include "traces/scene/cameras.h"
#include "traces/scenes/modelling/shapes.h"

namespace test {
namespace {

using traces::Scene;

/// Returns a scene with a white floor of 20 x 20 seen from above.
Scene floor_scene() {
  Scene scene;
  traces::add_material(scene, {});
  traces::add_object(scene, traces::make_quad("floor", {-10, 0, -10}, {0, 0, 20}, {20, 0, 0}, 4), 0);
  scene.cameras.push_back(traces::look_at("above", {0, 10, 8}, {0, 0, 0}, 0.8F));
  return scene;
}

void add_lamp(Scene& scene, const glm::vec3& corner, float size, const glm::vec3& emission) {
  traces::Material lamp;
  lamp.emission = emission;
  traces::add_object(scene, traces::make_quad("lamp", corner, {size, 0, 0}, {0, 0, size}, 2),
                     traces::add_material(scene, lamp));
}

TEST(EmitterLights, ALampBecomesAPointJustBelowIt) {
  Scene scene = floor_scene();
  add_lamp(scene, {-1, 6, -1}, 2, {5, 10, 0});
  traces::add_emitter_lights(scene);
  ASSERT_EQ(scene.lights.size(), 1U);
  EXPECT_EQ(scene.lights[0].intensity, glm::vec3(20, 40, 0));
  EXPECT_NEAR(scene.lights[0].position.x, 0, 1e-5);
  EXPECT_LT(scene.lights[0].position.y, 6);
  EXPECT_GT(scene.lights[0].position.y, 5.9);
  EXPECT_EQ(scene.materials[1].emission, glm::vec3(0.5F, 1, 0)) << "shown no brighter than white, hue kept";
}

TEST(EmitterLights, ALampWithAHousingShinesFromOutsideIt) {
  Scene scene = floor_scene();
  traces::Material lamp;
  lamp.emission = glm::vec3(2);
  traces::add_object(scene, traces::make_sphere("bulb", {0, 5, 0}, 0.5F, 4), traces::add_material(scene, lamp));
  traces::add_emitter_lights(scene);
  ASSERT_EQ(scene.lights.size(), 1U);
  EXPECT_GT(glm::length(scene.lights[0].position - glm::vec3(0, 5, 0)), 0.5F);
}

TEST(EmitterLights, WeakGlowAndNegligibleLampsAreNotLights) {
  Scene scene = floor_scene();
  add_lamp(scene, {0, 6, 0}, 1, glm::vec3(50));
  add_lamp(scene, {3, 6, 0}, 0.05F, glm::vec3(50));
  add_lamp(scene, {-9, 0.1F, 0}, 8, {0.4F, 0.1F, 0});
  traces::add_emitter_lights(scene);
  EXPECT_EQ(scene.lights.size(), 1U);
}

TEST(EmitterLights, TheStrongestFourComeStrongestFirst) {
  Scene scene = floor_scene();
  for (int i = 1; i <= 6; ++i) add_lamp(scene, {static_cast<float>(i), 6, 0}, 0.5F, glm::vec3(static_cast<float>(i)));
  traces::add_emitter_lights(scene);
  ASSERT_EQ(scene.lights.size(), traces::kMaxEmitterLights);
  EXPECT_FLOAT_EQ(scene.lights[0].intensity.x, 1.5F);
  EXPECT_FLOAT_EQ(scene.lights[3].intensity.x, 0.75F);
}

TEST(Exposure, TheBrightestTenthOfTheViewReceivesTheTarget) {
  Scene scene = floor_scene();
  traces::Light sun;
  sun.kind = traces::Light::Kind::kDirectional;
  sun.direction = {0, -1, 0};
  sun.intensity = {110'000, 55'000, 0};
  scene.lights.push_back(sun);
  traces::scale_lights_to_exposure(scene);
  EXPECT_NEAR(scene.lights[0].intensity.x, traces::kTargetIrradiance, 1e-4);
  EXPECT_NEAR(scene.lights[0].intensity.y, traces::kTargetIrradiance / 2, 1e-4);
  EXPECT_EQ(scene.ambient, glm::vec3(traces::kAmbient));
}

TEST(Exposure, ALightThatReachesNothingIsLeftAlone) {
  Scene scene = floor_scene();
  traces::Light away;
  away.kind = traces::Light::Kind::kDirectional;
  away.direction = {1, 0, 0};
  scene.lights.push_back(away);
  traces::scale_lights_to_exposure(scene);
  EXPECT_EQ(scene.lights[0].intensity, glm::vec3(1));
}

}  // namespace
}  // namespace test
