#include <cmath>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "tests/traces/scene/tiny_gltf_file.h"
#include "traces/scene/normals_tangents.h"

// Tests of tangents. Expected ones follow from Mikkelsen's rule and glTF's conventions: v grows downwards, the normal
// map's y upwards.

namespace test {
namespace {

using traces::Mesh;
using Tangents = std::vector<glm::vec4>;

/// Returns a mesh that faces +z.
Mesh flat_mesh(const std::vector<glm::vec2>& at, const std::vector<glm::vec2>& uvs,
               const std::vector<std::array<std::uint32_t, 3>>& triangles) {
  Mesh mesh;
  for (const glm::vec2& p : at) mesh.positions.emplace_back(p, 0);
  mesh.normals.assign(at.size(), {0, 0, 1});
  mesh.uvs = uvs;
  mesh.triangles = triangles;
  return mesh;
}

Mesh quad(const std::vector<glm::vec2>& uvs) {
  return flat_mesh({{0, 0}, {1, 0}, {1, 1}, {0, 1}}, uvs, {{0, 1, 2}, {0, 2, 3}});
}

void expect_near(const glm::vec4& a, const glm::vec4& b) {
  EXPECT_NEAR(glm::distance(a, b), 0, 1e-6) << a.x << " " << a.y << " " << a.z << " " << a.w;
}

TEST(Tangents, OfAQuadWhoseTextureIsUprightHaveAPositiveSign) {
  Mesh mesh = quad({{0, 1}, {1, 1}, {1, 0}, {0, 0}});
  EXPECT_EQ(traces::compute_tangents(mesh, false), (std::vector<std::uint32_t>{0, 1, 2, 3}));
  EXPECT_EQ(mesh.tangents, Tangents(4, {1, 0, 0, 1})) << "cross(z, x) * 1 is up, where v is 0";
}

TEST(Tangents, OfATurnedQuadTurnWithTheTexture) {
  Mesh mesh = quad({{1, 1}, {1, 0}, {0, 0}, {0, 1}});
  traces::compute_tangents(mesh, false);
  EXPECT_EQ(mesh.tangents, Tangents(4, {0, -1, 0, 1}));
}

TEST(Tangents, OfMirroredCoordinatesHaveANegativeSign) {
  Mesh across = quad({{1, 1}, {0, 1}, {0, 0}, {1, 0}});
  traces::compute_tangents(across, false);
  EXPECT_EQ(across.tangents, Tangents(4, {-1, 0, 0, -1}));
  Mesh down = quad({{0, 0}, {1, 0}, {1, 1}, {0, 1}});
  traces::compute_tangents(down, false);
  EXPECT_EQ(down.tangents, Tangents(4, {1, 0, 0, -1}));
}

TEST(Tangents, ComeFromTheCoordinatesOfTheNormalMap) {
  Mesh mesh = quad({{0, 1}, {1, 1}, {1, 0}, {0, 0}});
  mesh.second_uvs = {{1, 1}, {1, 0}, {0, 0}, {0, 1}};
  traces::compute_tangents(mesh, true);
  EXPECT_EQ(mesh.tangents, Tangents(4, {0, -1, 0, 1}));
}

/// Returns a strip whose u is 0, 1, 0 at x = 0, 1, 2: both halves share the vertices in the middle.
Mesh mirrored_strip() {
  return flat_mesh({{0, 0}, {1, 0}, {2, 0}, {0, 1}, {1, 1}, {2, 1}}, {{0, 1}, {1, 1}, {0, 1}, {0, 0}, {1, 0}, {0, 0}},
                   {{0, 1, 4}, {0, 4, 3}, {1, 2, 5}, {1, 5, 4}});
}

TEST(Tangents, SplitVerticesWhereTheTextureIsMirrored) {
  Mesh mesh = mirrored_strip();
  mesh.colours.assign(6, glm::vec4(1));
  mesh.colours[4] = glm::vec4(0.5F);
  EXPECT_EQ(traces::compute_tangents(mesh, false), (std::vector<std::uint32_t>{0, 1, 2, 3, 4, 5, 1, 4}));
  ASSERT_EQ(mesh.positions.size(), 8U);
  EXPECT_EQ(mesh.normals.size(), 8U);
  EXPECT_EQ(mesh.positions[7], mesh.positions[4]);
  EXPECT_EQ(mesh.uvs[6], mesh.uvs[1]);
  EXPECT_EQ(mesh.colours[7], glm::vec4(0.5F));
  for (std::size_t t = 0; t < 4; ++t) {
    for (const std::uint32_t vertex : mesh.triangles[t]) {
      EXPECT_EQ(mesh.tangents[vertex], t < 2 ? glm::vec4(1, 0, 0, 1) : glm::vec4(-1, 0, 0, -1)) << t;
    }
  }
}

/// Corners of two triangles that share the origin, with angles there of 90 and 45 degrees. Texture coordinate u
/// increases along (1, 0) in the first and along (1, -1) in the second.
constexpr std::array<glm::vec2, 4> kFanAt{{{0, 0}, {1, 0}, {0, 1}, {-1, 1}}};
constexpr std::array<glm::vec2, 4> kFanUvs{{{0, 0}, {1, 0}, {0, -1}, {-1, 0}}};
/// The tangent that is expected: 90 (1, 0) + 45 (1, -1) / sqrt(2), normalised.
const glm::vec4 kFanTangent(0.9675382F, -0.2527247F, 0, 1);

TEST(Tangents, AreWeightedByAngle) {
  Mesh mesh = flat_mesh({kFanAt.begin(), kFanAt.end()}, {kFanUvs.begin(), kFanUvs.end()}, {{0, 1, 2}, {0, 2, 3}});
  traces::compute_tangents(mesh, false);
  ASSERT_EQ(mesh.tangents.size(), 4U);
  expect_near(mesh.tangents[0], kFanTangent);
  expect_near(mesh.tangents[1], {1, 0, 0, 1});
  expect_near(mesh.tangents[3], {std::sqrt(0.5F), -std::sqrt(0.5F), 0, 1});
}

TEST(Tangents, TakeEqualVerticesAsOne) {
  std::vector<glm::vec2> at, uvs;
  for (const std::size_t i : {0, 1, 2, 0, 2, 3}) at.push_back(kFanAt[i]), uvs.push_back(kFanUvs[i]);
  Mesh mesh = flat_mesh(at, uvs, {{0, 1, 2}, {3, 4, 5}});
  traces::compute_tangents(mesh, false);
  ASSERT_EQ(mesh.tangents.size(), 6U);
  expect_near(mesh.tangents[0], kFanTangent);
  EXPECT_EQ(mesh.tangents[3], mesh.tangents[0]);
}

TEST(Tangents, OfTrianglesThatShareAVertexButNoEdgeAreTheirOwn) {
  Mesh mesh = flat_mesh({{0, 0}, {1, 0}, {1, 1}, {-1, 0}, {-1, -1}}, {{0, 0}, {1, 0}, {1, -1}, {0, 1}, {1, 1}},
                        {{0, 1, 2}, {0, 3, 4}});
  EXPECT_EQ(traces::compute_tangents(mesh, false).size(), 6U);
  EXPECT_EQ(mesh.tangents[mesh.triangles[0][0]], glm::vec4(1, 0, 0, 1));
  EXPECT_EQ(mesh.tangents[mesh.triangles[1][0]], glm::vec4(0, -1, 0, 1)) << "u grows down there";
}

TEST(Tangents, OfTrianglesWithoutTextureAreaAreTheirNeighbours) {
  Mesh mesh = quad({{0, 1}, {1, 1}, {1, 0}, {0.5F, 0.5F}});
  traces::compute_tangents(mesh, false);
  ASSERT_EQ(mesh.tangents.size(), 4U);
  EXPECT_EQ(mesh.tangents[0], glm::vec4(1, 0, 0, 1));
  EXPECT_EQ(mesh.tangents[2], glm::vec4(1, 0, 0, 1));
}

TEST(Tangents, AreUnitAndPerpendicularWhateverTheCoordinatesAre) {
  for (const auto& uvs : {std::vector<glm::vec2>{}, std::vector<glm::vec2>(4, {0.5F, 0.5F}),
                          std::vector<glm::vec2>{{0, 0}, {1e-30F, 0}, {1e30F, 1}, {0, -1e30F}}}) {
    Mesh mesh = quad(uvs);
    mesh.triangles.push_back({0, 0, 1});  // no area
    traces::compute_tangents(mesh, false);
    for (std::size_t i = 0; i < mesh.tangents.size(); ++i) {
      const glm::vec3 tangent(mesh.tangents[i]);
      EXPECT_NEAR(glm::length(tangent), 1, 1e-6F);
      EXPECT_NEAR(glm::dot(tangent, mesh.normals[i]), 0, 1e-6F);
      EXPECT_EQ(std::abs(mesh.tangents[i].w), 1);
    }
  }
}

TEST(Tangents, OfMovingMeshesSplitWhatMovesThem) {
  TinyGltf file;
  const Mesh strip = mirrored_strip();
  std::vector<float> positions, normals, uvs, moves;
  std::vector<std::uint16_t> indices;
  for (std::size_t i = 0; i < 6; ++i) {
    positions.insert(positions.end(), {strip.positions[i].x, strip.positions[i].y, 0});
    normals.insert(normals.end(), {0, 0, 1});
    uvs.insert(uvs.end(), {strip.uvs[i].x, strip.uvs[i].y});
    moves.insert(moves.end(), {0, 0, static_cast<float>(i)});
  }
  for (const auto& triangle : strip.triangles) indices.insert(indices.end(), triangle.begin(), triangle.end());
  auto& primitive = file.primitive();
  primitive["attributes"] = {{"POSITION", file.add(positions, kFloat, "VEC3", 6)},
                             {"NORMAL", file.add(normals, kFloat, "VEC3", 6)},
                             {"TEXCOORD_0", file.add(uvs, kFloat, "VEC2", 6)}};
  primitive["indices"] = file.add(indices, kUShort, "SCALAR", indices.size());
  primitive["targets"] = {{{"POSITION", file.add(moves, kFloat, "VEC3", 6)}}};
  file.json["textures"] = {{{"source", 0}}};
  file.json["images"] = {
      {{"uri",
        "data:image/"
        "png;base64,iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAIAAACQd1PeAAAADElEQVR4nGNoaPgPAAODAgAApfuJAAAAAElFTkSuQmCC"}}};
  file.material()["normalTexture"] = {{"index", 0}};
  const traces::Scene scene = load(file);
  const Mesh& mesh = scene.meshes.at(0);
  ASSERT_EQ(mesh.positions.size(), 8U);
  ASSERT_NE(mesh.deformation, nullptr);
  EXPECT_EQ(mesh.deformation->tangents, mesh.tangents);
  ASSERT_EQ(mesh.deformation->target_positions.at(0).size(), 8U);
  EXPECT_EQ(mesh.deformation->target_positions[0][6], glm::vec3(0, 0, 1));
  EXPECT_EQ(mesh.deformation->target_positions[0][7], glm::vec3(0, 0, 4));
}

}  // namespace
}  // namespace test
