#include <algorithm>
#include <cmath>
#include <string>
#include <string_view>

#include <gtest/gtest.h>

#include "traces/scene/animation.h"
#include "traces/scene/bounds.h"
#include "traces/scenes/builtin.h"
#include "traces/scenes/chess/pieces.h"
#include "traces/scenes/laboratory/glassware.h"
#include "traces/scenes/modelling/shapes.h"

namespace test {
namespace {

using traces::Instance;
using traces::Mesh;
using traces::Scene;

std::uint32_t class_of(std::string_view name) {
  for (const traces::BuiltinInfo& info : traces::builtin_scenes()) {
    if (info.name == name) return info.triangles;
  }
  return 0;
}

/// Returns the number of triangles of a scene as a fraction of the requested number.
double share_of(std::string_view name, std::uint32_t wanted) {
  const Scene scene = traces::build_scene(name, {.triangles = wanted});
  return static_cast<double>(traces::count_triangles(scene)) / wanted;
}

/// Returns the volume of a closed mesh; positive if its faces look outwards.
double volume(const Mesh& mesh) {
  double sum = 0;
  for (const auto& t : mesh.triangles) {
    const glm::dvec3 a(mesh.positions[t[0]]), b(mesh.positions[t[1]]), c(mesh.positions[t[2]]);
    sum += glm::dot(a, glm::cross(b, c)) / 6;
  }
  return sum;
}

bool is_hit(const Scene& scene, const glm::vec3& from, const glm::vec3& way) {
  for (const Instance& instance : scene.instances) {
    const Mesh& mesh = scene.meshes[instance.mesh];
    const glm::mat4 back = glm::inverse(instance.to_world);
    const glm::vec3 o(back * glm::vec4(from, 1)), d(back * glm::vec4(way, 0));
    for (const auto& t : mesh.triangles) {
      const glm::vec3 a = mesh.positions[t[0]], ab = mesh.positions[t[1]] - a, ac = mesh.positions[t[2]] - a;
      const glm::vec3 n = glm::cross(ab, ac);
      const float facing = glm::dot(d, n);
      if (facing == 0) continue;
      const glm::vec3 q = glm::cross(o - a, d);
      const float u = glm::dot(ac, q) / -facing, v = glm::dot(ab, q) / facing;
      if (u >= 0 && v >= 0 && u + v <= 1 && glm::dot(a - o, n) / facing > 1e-4F) return true;
    }
  }
  return false;
}

std::uint32_t node_called(const Scene& scene, std::string_view name) {
  for (std::uint32_t k = 0; k < scene.nodes.size(); ++k) {
    if (scene.nodes[k].name == name) return k;
  }
  return traces::kNone;
}

const Instance& hanging_on(const Scene& scene, std::uint32_t node) {
  return *std::ranges::find(scene.instances, node, &Instance::node);
}

glm::vec3 place_of(const glm::mat4& to_world) { return glm::vec3(to_world[3]); }

class Things : public testing::TestWithParam<const char*> {};

INSTANTIATE_TEST_SUITE_P(Scenes, Things, testing::Values("chess", "car", "laboratory"),
                         [](const auto& test) { return std::string(test.param); });

TEST_P(Things, HaveTheTrianglesOfTheirClass) { EXPECT_NEAR(share_of(GetParam(), class_of(GetParam())), 1, 0.05); }

TEST_P(Things, HaveAboutTheRequestedNumberOfTriangles) {
  const std::uint32_t normal = class_of(GetParam());
  for (const std::uint32_t wanted : {normal / 4, normal / 2, 2 * normal, 4 * normal}) {
    EXPECT_NEAR(share_of(GetParam(), wanted), 1, 0.25) << wanted;
  }
  EXPECT_LT(share_of(GetParam(), normal / 8), 2) << "shapes keep what makes them recognisable";
}

TEST_P(Things, AreTheSameEachTime) {
  EXPECT_EQ(traces::build_scene(GetParam()).sha256, traces::build_scene(GetParam()).sha256);
}

TEST_P(Things, AreWhole) {
  for (const std::uint32_t triangles : {0U, class_of(GetParam()) / 8, 4 * class_of(GetParam())}) {
    const Scene scene = traces::build_scene(GetParam(), {.triangles = triangles});
    EXPECT_EQ(scene.name, GetParam());
    EXPECT_GE(scene.textures.size(), 2U);
    EXPECT_GE(scene.lights.size(), 1U);
    EXPECT_LE(scene.lights.size(), 4U);
    for (const traces::Material& m : scene.materials) {
      EXPECT_TRUE(!m.base_texture.is_used() || m.base_texture.texture < scene.textures.size()) << m.name;
    }
    for (const Instance& instance : scene.instances) {
      ASSERT_LT(instance.mesh, scene.meshes.size());
      ASSERT_TRUE(instance.node == traces::kNone || instance.node < scene.nodes.size());
    }
    for (const Mesh& mesh : scene.meshes) {
      ASSERT_LT(mesh.material, scene.materials.size()) << mesh.name;
      ASSERT_FALSE(mesh.triangles.empty()) << mesh.name;
      ASSERT_EQ(mesh.normals.size(), mesh.positions.size()) << mesh.name;
      ASSERT_EQ(mesh.uvs.size(), mesh.positions.size()) << mesh.name;
      for (const glm::vec3& p : mesh.positions) ASSERT_TRUE(std::isfinite(p.x + p.y + p.z)) << mesh.name;
      for (const glm::vec3& n : mesh.normals) ASSERT_NEAR(glm::length(n), 1, 1e-4) << mesh.name;
      for (const auto& t : mesh.triangles) {
        for (const std::uint32_t corner : t) ASSERT_LT(corner, mesh.positions.size()) << mesh.name;
      }
    }
  }
}

TEST_P(Things, StayInTheirRoomAllTheTime) {
  Scene scene = traces::build_scene(GetParam());
  const traces::Bounds at_rest = traces::world_bounds(scene);
  EXPECT_LT(at_rest.diagonal(), 70);
  for (double seconds = 0; seconds <= traces::animation_seconds(scene); seconds += 0.5) {
    traces::pose_scene(scene, seconds);
    const traces::Bounds bounds = traces::world_bounds(scene);
    EXPECT_LT(glm::length(bounds.lower - at_rest.lower), 1e-3F) << seconds;
    EXPECT_LT(glm::length(bounds.upper - at_rest.upper), 1e-3F) << seconds;
    for (const traces::Camera& camera : scene.cameras) {
      const glm::vec3 eye = place_of(camera.to_world);
      EXPECT_TRUE(glm::all(glm::lessThan(at_rest.lower, eye)) && glm::all(glm::lessThan(eye, at_rest.upper)))
          << camera.name << " at " << seconds;
    }
  }
}

TEST_P(Things, FillThePicture) {
  const Scene scene = traces::build_scene(GetParam(), {.triangles = class_of(GetParam()) / 4});
  const traces::Camera& camera = scene.cameras.front();
  const float slope = std::tan(0.5F * camera.vertical_fov);
  for (int x = -3; x <= 3; ++x) {
    for (int y = -2; y <= 2; ++y) {
      const glm::vec4 way(2 * slope * static_cast<float>(x) / 3.2F, slope * static_cast<float>(y) / 2.2F, -1, 0);
      EXPECT_TRUE(is_hit(scene, place_of(camera.to_world), glm::vec3(camera.to_world * way))) << x << ", " << y;
    }
  }
}

class Paths : public testing::TestWithParam<const char*> {};

INSTANTIATE_TEST_SUITE_P(Scenes, Paths, testing::Values("chess", "car", "laboratory", "cornell", "teapot", "crowd"),
                         [](const auto& test) { return std::string(test.param); });

TEST_P(Paths, LeadACameraForSomeSeconds) {
  Scene scene = traces::build_scene(GetParam());
  EXPECT_GE(traces::animation_seconds(scene), 4);
  EXPECT_LE(traces::animation_seconds(scene), 30);
  const auto path = std::ranges::find(scene.cameras, "path", &traces::Camera::name);
  ASSERT_NE(path, scene.cameras.end());
  EXPECT_NE(path, scene.cameras.begin()) << "the first camera is the picture's";
  EXPECT_EQ(scene.cameras.front().node, traces::kNone);
  const glm::vec3 start = place_of(path->to_world);
  traces::pose_scene(scene, 0.5 * traces::animation_seconds(scene));
  EXPECT_GT(glm::length(place_of(path->to_world) - start), 0.3F);
}

TEST(CornellAndTeapot, HaveAboutTheRequestedNumberOfTriangles) {
  for (const char* name : {"cornell", "teapot"}) {
    EXPECT_EQ(traces::count_triangles(traces::build_scene(name, {.triangles = class_of(name)})),
              traces::count_triangles(traces::build_scene(name)));
    for (const std::uint32_t wanted : {class_of(name) / 8, class_of(name) / 2, 4 * class_of(name)}) {
      EXPECT_NEAR(share_of(name, wanted), 1, 0.25) << name << " " << wanted;
    }
  }
}

TEST(ChessPieces, LookOutwardsAndStandOnTheBoard) {
  for (std::size_t k = 0; k < traces::chess::kPieces; ++k) {
    const Mesh piece = traces::chess::make_piece(static_cast<traces::chess::Piece>(k), {});
    EXPECT_GT(volume(piece), 0.05) << piece.name;
    traces::Bounds bounds;
    for (const glm::vec3& p : piece.positions) bounds.add(p);
    EXPECT_EQ(bounds.lower.y, 0) << piece.name;
    EXPECT_LT(std::max(bounds.upper.x, -bounds.lower.x), 0.5F) << piece.name << " keeps to its square";
  }
  EXPECT_GT(volume(traces::chess::make_horse({})), 0.02);
}

TEST(ChessGame, KnightAndBishopTake) {
  Scene scene = traces::build_scene("chess");
  const std::uint32_t knight = node_called(scene, "f3"), bishop = node_called(scene, "g4");
  EXPECT_EQ(place_of(hanging_on(scene, knight).to_world), glm::vec3(1.5F, 0, 1.5F));
  traces::pose_scene(scene, 1.9);
  EXPECT_GT(place_of(hanging_on(scene, knight).to_world).y, 0.5F) << "in the air";
  traces::pose_scene(scene, 6);
  EXPECT_LT(glm::length(place_of(hanging_on(scene, knight).to_world) - glm::vec3(0.5F, 0, -0.5F)), 1e-4F) << "e5";
  EXPECT_LT(glm::length(place_of(hanging_on(scene, bishop).to_world) - glm::vec3(-0.5F, 0, 3.5F)), 1e-4F) << "d1";
  for (const char* const taken : {"e5", "d1"}) {
    const glm::vec3 position = place_of(hanging_on(scene, node_called(scene, taken)).to_world);
    EXPECT_GT(std::abs(position.x), 5) << taken << " is beside the board";
  }
}

TEST(Car, WheelsRollWithoutSlipping) {
  Scene scene = traces::build_scene("car");
  const std::uint32_t wheel = node_called(scene, "wheel");
  constexpr double kStep = 1e-3;
  for (const double seconds : {1.4, 3.01, 4.7}) {
    traces::pose_scene(scene, seconds);
    const glm::mat4 before = hanging_on(scene, wheel).to_world;
    const glm::vec3 axle = place_of(before);
    const glm::vec4 touching = glm::inverse(before) * glm::vec4(axle - glm::vec3(0, axle.y, 0), 1);
    traces::pose_scene(scene, seconds + kStep);
    const glm::mat4 after = hanging_on(scene, wheel).to_world;
    const float travelled = (place_of(after) - axle).x;
    EXPECT_GT(travelled, 1e-4F);
    EXPECT_LT(glm::length(glm::vec3((after - before) * touching)), 0.06F * travelled) << seconds;
  }
}

TEST(Laboratory, LiquidDoesNotTouchTheGlass) {
  using traces::laboratory::Vessel;
  for (const Vessel vessel : {Vessel::kBeaker, Vessel::kErlenmeyer, Vessel::kRound, Vessel::kVolumetric}) {
    const Mesh glass = traces::laboratory::make_vessel(vessel, {2}),
               liquid = traces::laboratory::make_filling(vessel, 0.05F, {2});
    traces::Bounds outside, inside;
    for (const glm::vec3& p : glass.positions) outside.add(p);
    for (const glm::vec3& p : liquid.positions) inside.add(p);
    EXPECT_GT(volume(liquid), 0);
    EXPECT_GT(volume(glass), 0) << "thin, but glass";
    EXPECT_LT(volume(glass), 0.6 * volume(liquid)) << "it is hollow";
    EXPECT_GT(inside.lower.y, outside.lower.y + 0.003F);
    EXPECT_NEAR(inside.upper.y, 0.05, 1e-4);
  }
}

TEST(Turned, SimplifiedKeepsEndsAndCorners) {
  const std::vector<glm::vec2> line{{0, 0}, {0.5F, 0}, {1, 0}, {1, 0.4F}, {1, 1}};
  EXPECT_EQ(traces::simplify_line(line, 3), (std::vector<glm::vec2>{{0, 0}, {1, 0}, {1, 1}}));
}

TEST(Detail, FitDetailMeetsTheWantedCount) {
  const auto triangles = [](const traces::Detail& detail) {
    return 100 + static_cast<std::uint64_t>(1000 * detail.share * detail.share);
  };
  EXPECT_EQ(traces::fit_detail(1100, triangles).share, 1);
  for (const std::uint64_t wanted : {400U, 9000U}) {
    EXPECT_NEAR(static_cast<double>(triangles(traces::fit_detail(wanted, triangles))) / static_cast<double>(wanted), 1,
                0.02);
  }
}

}  // namespace
}  // namespace test
