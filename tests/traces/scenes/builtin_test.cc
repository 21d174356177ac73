#include "traces/scenes/builtin.h"

#include <cmath>
#include <functional>
#include <map>
#include <string>
#include <string_view>
#include <utility>

#include <gtest/gtest.h>

#include "sim/error.h"
#include "tests/traces/scene/tiny_gltf_file.h"
#include "traces/scene/bounds.h"
#include "traces/scene/info.h"
#include "traces/scenes/library.h"
#include "traces/scenes/modelling/shapes.h"
#include "traces/scenes/teapot.h"

namespace test {
namespace {

using traces::Scene;

class Builtin : public testing::TestWithParam<std::string> {};

TEST_P(Builtin, IsWholeAndFinite) {
  const Scene scene = traces::build_scene(GetParam());
  EXPECT_EQ(scene.name, GetParam());
  EXPECT_EQ(scene.sha256.size(), 64U);
  EXPECT_EQ(scene.sha256, traces::build_scene(GetParam()).sha256);
  ASSERT_FALSE(scene.cameras.empty());
  EXPECT_EQ(scene.lights.size(), 1U);
  for (const traces::Instance& instance : scene.instances) ASSERT_LT(instance.mesh, scene.meshes.size());
  for (const traces::Mesh& mesh : scene.meshes) {
    ASSERT_LT(mesh.material, scene.materials.size());
    ASSERT_EQ(mesh.normals.size(), mesh.positions.size());
    for (const glm::vec3& p : mesh.positions) ASSERT_TRUE(std::isfinite(p.x + p.y + p.z));
    for (const glm::vec3& n : mesh.normals) ASSERT_NEAR(glm::length(n), 1, 1e-5);
    for (const auto& triangle : mesh.triangles) {
      glm::vec3 p[3];
      for (std::size_t k = 0; k < 3; ++k) {
        ASSERT_LT(triangle[k], mesh.positions.size());
        p[k] = mesh.positions[triangle[k]];
      }
      const glm::vec3 normal = glm::cross(p[1] - p[0], p[2] - p[0]);
      ASSERT_GT(glm::length(normal), 0);
      ASSERT_GT(glm::dot(glm::normalize(normal), mesh.normals[triangle[0]]), 0.3F)
          << mesh.name << ": winding and normal";
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Scenes, Builtin, testing::Values("cornell", "teapot"),
                         [](const auto& test) { return test.param; });

TEST(BuiltinScenes, HaveTheSameBitsByEveryCompiler) {
  const std::pair<const char*, const char*> hashes[] = {
      {"atrium", "2988c027c52e1d8c"},     {"bathroom", "b2c5ecb01bbff1fe"},   {"car", "874f40d0250f92ca"},
      {"chess", "c89d7c2d940d8a14"},      {"conference", "5337138ec69dfc97"}, {"cornell", "9471b407625b0633"},
      {"crowd", "3e0cf2c95963af05"},      {"forest", "fb04767b88265ab4"},     {"hairball", "8164ca0742d38f96"},
      {"laboratory", "0a3a730c02e4576e"}, {"teapot", "ba05198197211764"},     {"village", "01dd20d234e8adb1"}};
  for (const auto& [name, hash] : hashes) EXPECT_EQ(traces::build_scene(name).sha256.substr(0, 16), hash) << name;
}

TEST(BuiltinScenes, AreTheSizeTheyClaim) {
  EXPECT_EQ(traces::scene_info(traces::build_scene("cornell")).triangles, 10'338U);
  EXPECT_EQ(traces::scene_info(traces::build_scene("teapot")).triangles, 14'792U);
}

TEST(BuiltinScenes, CornellBoxIsTwoByOne) {
  const traces::Bounds bounds = traces::world_bounds(traces::build_scene("cornell"));
  EXPECT_EQ(bounds.lower, glm::vec3(-2, -1, -1));
  EXPECT_EQ(bounds.upper, glm::vec3(2, 1, 1));
}

TEST(BuiltinScenes, TheTeapotShinesAndItsFloorIsTextured) {
  const Scene scene = traces::build_scene("teapot");
  EXPECT_GT(scene.materials.at(0).mirror, 0);
  ASSERT_EQ(scene.textures.size(), 1U);
  EXPECT_EQ(scene.materials.at(1).base_texture.texture, 0U);
  EXPECT_EQ(scene.textures[0].texels.size(), std::size_t{scene.textures[0].width} * scene.textures[0].height);
}

TEST(Teapot, HasNewellsProportions) {
  const std::vector<traces::BezierPatch> patches = traces::teapot_patches();
  ASSERT_EQ(patches.size(), 32U);
  traces::Bounds bounds;
  for (const auto& patch : patches) {
    for (int i = 0; i <= 8; ++i) {
      for (int j = 0; j <= 8; ++j) {
        bounds.add(traces::evaluate_patch(patch, static_cast<float>(i) / 8, static_cast<float>(j) / 8).position);
      }
    }
  }
  EXPECT_NEAR(bounds.lower.x, -3, 0.05);
  EXPECT_NEAR(bounds.upper.x, 3.43, 0.05);
  EXPECT_NEAR(bounds.lower.y, 0, 1e-6);
  EXPECT_NEAR(bounds.upper.y, 3.15, 1e-6);
  EXPECT_NEAR(bounds.upper.z, 2, 1e-6);
}

TEST(OpenScene, TakesBuiltInNames) { EXPECT_EQ(traces::open_scene("teapot").name, "teapot"); }

TEST(OpenScene, SuggestsTheNearestName) {
  try {
    traces::open_scene("cornel");
    FAIL();
  } catch (const sim::InputError& error) {
    const std::string what = error.what();
    EXPECT_NE(what.find("did you mean 'cornell'?"), std::string::npos) << what;
    EXPECT_NE(what.find("teapot"), std::string::npos) << what;
  }
}

TEST(OpenScene, LooksForFilesInTheFoldersOfThePath) {
  const TempFolder folder;
  folder.write("mine.glb", TinyGltf().glb());
  setenv("RAYWATT_PATH", ("/nowhere:" + folder.path().string()).c_str(), 1);
  EXPECT_EQ(traces::open_scene("mine").name, "mine");
  EXPECT_EQ(traces::open_scene("teapot").name, "teapot");
  EXPECT_THROW(traces::open_scene("yours"), sim::InputError);
  unsetenv("RAYWATT_PATH");
}

TEST(OpenScene, SlashesAndExtensionsMakeAPath) {
  for (const char* path : {"./cornell", "cornell.glb", "nowhere/cornell"}) {
    EXPECT_THROW(traces::open_scene(path), sim::InputError) << path;
  }
}

struct Room {
  std::string name;
  std::uint32_t triangles;
  double smallest;  // fraction of the triangles below which shapes would be lost
  float size;       // upper bound of the distance from the origin, in metres
};

std::ostream& operator<<(std::ostream& out, const Room& room) { return out << room.name; }

/// True if the segment from `from` to `from` + `way` hits a triangle of the scene.
bool is_blocked(const Scene& scene, const glm::vec3& from, const glm::vec3& way) {
  for (const traces::Instance& instance : scene.instances) {
    const traces::Mesh& mesh = scene.meshes[instance.mesh];
    const auto corner = [&](std::uint32_t i) { return glm::vec3(instance.to_world * glm::vec4(mesh.positions[i], 1)); };
    for (const auto& t : mesh.triangles) {
      const glm::vec3 a = corner(t[0]), e = corner(t[1]) - a, f = corner(t[2]) - a;
      const glm::vec3 across = glm::cross(way, f);
      const float volume = glm::dot(e, across);
      if (std::abs(volume) < 1e-12F) continue;
      const glm::vec3 s = from - a, q = glm::cross(s, e);
      const float u = glm::dot(s, across) / volume, v = glm::dot(way, q) / volume, at = glm::dot(f, q) / volume;
      if (u >= 0 && v >= 0 && u + v <= 1 && at > 0 && at < 1) return true;
    }
  }
  return false;
}

/// Returns a built-in scene, which is built once for all tests.
const Scene& scene_called(std::string_view name) {
  static std::map<std::string, Scene, std::less<>> scenes;
  const auto found = scenes.find(name);
  return found != scenes.end() ? found->second : scenes.emplace(name, traces::build_scene(name)).first->second;
}

class Rooms : public testing::TestWithParam<Room> {
 protected:
  const Scene& scene_ = scene_called(GetParam().name);
};

TEST_P(Rooms, AreTheSizeOfTheirClass) {
  EXPECT_NEAR(static_cast<double>(traces::count_triangles(scene_)), GetParam().triangles, 0.05 * GetParam().triangles);
}

TEST_P(Rooms, HaveAboutTheRequestedNumberOfTriangles) {
  for (const double share : {GetParam().smallest, 4.0}) {
    const double wanted = share * GetParam().triangles;
    const Scene scene = traces::build_scene(GetParam().name, {.triangles = static_cast<std::uint32_t>(wanted)});
    EXPECT_NEAR(static_cast<double>(traces::count_triangles(scene)), wanted, 0.25 * wanted);
  }
}

TEST_P(Rooms, AreTheSameEveryTime) { EXPECT_EQ(scene_.sha256, traces::build_scene(GetParam().name).sha256); }

TEST_P(Rooms, HaveWholeMeshes) {
  for (const traces::Instance& instance : scene_.instances) ASSERT_LT(instance.mesh, scene_.meshes.size());
  for (const traces::Mesh& mesh : scene_.meshes) {
    ASSERT_FALSE(mesh.name.empty());
    ASSERT_FALSE(mesh.triangles.empty()) << mesh.name;
    ASSERT_LT(mesh.material, scene_.materials.size()) << mesh.name;
    ASSERT_EQ(mesh.normals.size(), mesh.positions.size()) << mesh.name;
    ASSERT_TRUE(mesh.uvs.empty() || mesh.uvs.size() == mesh.positions.size()) << mesh.name;
    for (const glm::vec3& p : mesh.positions) ASSERT_TRUE(std::isfinite(p.x + p.y + p.z)) << mesh.name;
    for (const glm::vec3& n : mesh.normals) ASSERT_NEAR(glm::length(n), 1, 1e-4) << mesh.name;
  }
}

TEST_P(Rooms, HaveNormalsOnTheSideThatFacesAreWoundFor) {
  for (const traces::Mesh& mesh : scene_.meshes) {
    std::size_t against = 0;
    for (const auto& triangle : mesh.triangles) {
      glm::vec3 p[3], n(0);
      for (std::size_t k = 0; k < 3; ++k) {
        ASSERT_LT(triangle[k], mesh.positions.size()) << mesh.name;
        p[k] = mesh.positions[triangle[k]];
        n += mesh.normals[triangle[k]];
      }
      const glm::vec3 face = glm::cross(p[1] - p[0], p[2] - p[0]);
      ASSERT_GT(glm::length(face), 0) << mesh.name;
      if (glm::dot(glm::normalize(face), n) < 0.3F) ++against;
    }
    EXPECT_EQ(against, 0U) << mesh.name << ", of " << mesh.triangles.size();
  }
}

TEST_P(Rooms, StayWithinTheirWalls) {
  const traces::Bounds bounds = traces::world_bounds(scene_);
  const glm::vec3 reach = glm::max(glm::abs(bounds.lower), glm::abs(bounds.upper));
  EXPECT_LT(std::max(reach.x, std::max(reach.y, reach.z)), GetParam().size);
  EXPECT_GE(bounds.lower.y, -0.01F);
}

TEST_P(Rooms, AreTexturedLitAndHaveCameras) {
  EXPECT_GE(scene_.textures.size(), 4U);
  for (const traces::Texture& texture : scene_.textures) {
    EXPECT_EQ(texture.texels.size(), std::size_t{texture.width} * texture.height) << texture.name;
  }
  for (const traces::Material& m : scene_.materials) {
    if (!m.base_texture.is_used()) continue;
    ASSERT_LT(m.base_texture.texture, scene_.textures.size()) << m.name;
    EXPECT_FALSE(scene_.textures[m.base_texture.texture].name.empty());
  }
  EXPECT_FALSE(scene_.lights.empty());
  EXPECT_GE(scene_.cameras.size(), 2U);
  EXPECT_EQ(scene_.cameras.back().name, "path");
  EXPECT_NE(scene_.cameras.back().node, traces::kNone);
}

TEST_P(Rooms, FillTheFirstCamerasPicture) {
  constexpr int kRays = 10;
  const traces::Camera& camera = scene_.cameras[0];
  const float slope = std::tan(0.5F * camera.vertical_fov);
  int hits = 0;
  for (int y = 0; y < kRays; ++y) {
    for (int x = 0; x < kRays; ++x) {
      const auto offset = [](int k) { return 2 * (static_cast<float>(k) + 0.5F) / kRays - 1; };
      const glm::vec4 way(2 * slope * offset(x), slope * offset(y), -1, 0);
      if (is_blocked(scene_, glm::vec3(camera.to_world[3]), 100.0F * glm::vec3(camera.to_world * way))) ++hits;
    }
  }
  EXPECT_GE(hits, kRays * kRays * 8 / 10);
}

TEST_P(Rooms, LetTheirCameraPassFreely) {
  const std::uint32_t node = scene_.cameras.back().node;
  for (const traces::Track& track : scene_.tracks) {
    if (track.node != node || track.path != traces::Track::Path::kTranslation) continue;
    EXPECT_GE(track.times.back(), 4);
    EXPECT_LE(track.times.back(), 30);
    for (std::size_t k = 0; k + 5 < track.values.size(); k += 3) {
      const glm::vec3 from(track.values[k], track.values[k + 1], track.values[k + 2]);
      const glm::vec3 to(track.values[k + 3], track.values[k + 4], track.values[k + 5]);
      EXPECT_FALSE(is_blocked(scene_, from, to - from)) << "between keys " << k / 3 << " and " << k / 3 + 1;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Scenes, Rooms,
                         testing::Values(Room{"conference", 190'000, 0.125, 5}, Room{"bathroom", 270'000, 0.125, 3},
                                         Room{"atrium", 66'000, 0.25, 13}),
                         [](const auto& test) { return test.param.name; });

TEST(Conference, HasFiveViewsThatDiffer) {
  const Scene& scene = scene_called("conference");
  ASSERT_EQ(scene.cameras.size(), 6U);
  for (std::size_t i = 0; i < 5; ++i) {
    EXPECT_EQ(scene.cameras[i].node, traces::kNone);
    for (std::size_t j = 0; j < i; ++j) {
      const glm::mat4 &a = scene.cameras[i].to_world, &b = scene.cameras[j].to_world;
      EXPECT_GT(glm::length(a[3] - b[3]) + glm::length(a[2] - b[2]), 1) << i << " and " << j;
      EXPECT_NE(scene.cameras[i].name, scene.cameras[j].name);
    }
  }
}

TEST(Bathroom, HasAMirrorAndSeeThroughThings) {
  int mirrors = 0, clear = 0;
  for (const traces::Material& m : scene_called("bathroom").materials) {
    mirrors += m.mirror > 0.9F ? 1 : 0;
    clear += m.transmission > 0.9F ? 1 : 0;
  }
  EXPECT_GE(mirrors, 1);
  EXPECT_GE(clear, 1);
}

TEST(Atrium, IsLitByTheSun) { EXPECT_EQ(scene_called("atrium").lights.at(0).kind, traces::Light::Kind::kDirectional); }

}  // namespace
}  // namespace test
