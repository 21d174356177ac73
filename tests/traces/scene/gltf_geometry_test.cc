#include <cmath>

#include <gtest/gtest.h>

#include "tests/traces/scene/tiny_gltf_file.h"
#include "traces/scene/bounds.h"
#include "traces/scene/info.h"

namespace test {
namespace {

using traces::Scene;

glm::vec3 corner(const Scene& scene, std::size_t instance, std::size_t vertex) {
  const traces::Instance& placed = scene.instances.at(instance);
  return glm::vec3(placed.to_world * glm::vec4(scene.meshes[placed.mesh].positions.at(vertex), 1));
}

void expect_near(const glm::vec3& a, const glm::vec3& b) {
  for (int k = 0; k < 3; ++k) EXPECT_NEAR(a[k], b[k], 1e-5F) << k;
}

TEST(GltfGeometry, ATriangleIsReadFromTextAndFromBinaryAlike) {
  const TempFolder folder;
  const TinyGltf file;
  const Scene text = traces::load_gltf(folder.write("a.gltf", file.text()));
  const Scene binary = traces::load_gltf(folder.write("b.glb", file.glb()));
  ASSERT_EQ(text.meshes.size(), 1U);
  EXPECT_EQ(text.name, "a");
  EXPECT_EQ(text.meshes[0].name, "part");
  EXPECT_EQ(text.meshes[0].positions, binary.meshes.at(0).positions);
  EXPECT_EQ(text.meshes[0].triangles, binary.meshes[0].triangles);
  EXPECT_EQ(text.sha256.size(), 64U);
  EXPECT_NE(text.sha256, binary.sha256);
}

TEST(GltfGeometry, MissingNormalsAreTheTrianglesOwn) {
  TinyGltf file;
  file.primitive()["indices"] = file.add<std::uint8_t>({0, 1, 2, 0, 2, 1}, kUByte, "SCALAR", 6);
  const Scene scene = load(file);
  ASSERT_EQ(scene.meshes[0].normals.size(), 6U);  // the two sides share no vertex
  expect_near(scene.meshes[0].normals[0], {0, 0, 1});
  expect_near(scene.meshes[0].normals[3], {0, 0, -1});
}

TEST(GltfGeometry, GivenNormalsBecomeUnitLengthAndNullOnesAreReplaced) {
  TinyGltf file;
  file.primitive()["attributes"]["NORMAL"] = file.add<float>({0, 0, 5, 0, 0, 0, 0, 3, 4}, kFloat, "VEC3", 3);
  const Scene scene = load(file);
  expect_near(scene.meshes[0].normals[0], {0, 0, 1});
  expect_near(scene.meshes[0].normals[1], {0, 0, 1});
  expect_near(scene.meshes[0].normals[2], {0, 0.6F, 0.8F});
}

TEST(GltfGeometry, EveryIndexTypeAndNoIndicesGiveTheSameTriangle) {
  const Scene expected = load(TinyGltf());
  TinyGltf bytes, words, none;
  bytes.primitive()["indices"] = bytes.add<std::uint8_t>({0, 1, 2}, kUByte, "SCALAR", 3);
  words.primitive()["indices"] = words.add<std::uint32_t>({0, 1, 2}, kUInt, "SCALAR", 3);
  none.primitive().erase("indices");
  for (const TinyGltf& file : {bytes, words, none})
    EXPECT_EQ(load(file).meshes[0].positions, expected.meshes[0].positions);
}

TEST(GltfGeometry, StripsAndFansKeepTheirWinding) {
  for (const int mode : {5, 6}) {
    TinyGltf file;
    const std::vector<float> square = mode == 5 ? std::vector<float>{0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0}
                                                : std::vector<float>{0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0};
    file.primitive()["attributes"]["POSITION"] = file.add<float>(square, kFloat, "VEC3", 4);
    file.primitive()["mode"] = mode;
    file.primitive().erase("indices");
    const Scene scene = load(file);
    ASSERT_EQ(scene.meshes[0].triangles.size(), 2U);
    for (const glm::vec3& normal : scene.meshes[0].normals) expect_near(normal, {0, 0, 1});
  }
}

TEST(GltfGeometry, StitchingTrianglesOfAStripAreDropped) {
  TinyGltf file;
  file.primitive()["mode"] = 5;
  file.primitive()["indices"] = file.add<std::uint8_t>({0, 1, 2, 2, 0, 0, 1, 2}, kUByte, "SCALAR", 8);
  EXPECT_EQ(load(file).meshes[0].triangles.size(), 2U);
}

TEST(GltfGeometry, LinesAndPointsAreSkippedWithAWarning) {
  TinyGltf file;
  nlohmann::json lines = file.primitive();
  lines["mode"] = 1;
  file.json["meshes"][0]["primitives"].push_back(lines);
  const Scene scene = load(file);
  EXPECT_EQ(scene.meshes.size(), 1U);
  ASSERT_EQ(scene.warnings.size(), 1U);
  EXPECT_NE(scene.warnings[0].find("points and lines"), std::string::npos);
}

TEST(GltfGeometry, NormalisedIntegersAreUnfolded) {
  TinyGltf file;
  file.primitive()["attributes"]["NORMAL"] =
      file.add<std::int8_t>({127, 0, 0, 0, 0, 127, 0, 0, 0, 127, 0, 0}, kByte, "VEC3", 3, true);
  file.json["bufferViews"].back()["byteStride"] = 4;
  const Scene scene = load(file);
  expect_near(scene.meshes[0].normals[0], {1, 0, 0});
  expect_near(scene.meshes[0].normals[1], {0, 1, 0});
}

TEST(GltfGeometry, QuantisedPositionsAreReadAsIntegers) {
  TinyGltf bytes, words;
  bytes.primitive()["attributes"]["POSITION"] =
      bytes.add<std::int8_t>({0, 0, 0, 0, -100, 0, 0, 0, 0, 50, 0, 0}, kByte, "VEC3", 3);
  bytes.json["bufferViews"].back()["byteStride"] = 4;
  expect_near(corner(load(bytes), 0, 1), {-100, 0, 0});
  words.primitive()["attributes"]["POSITION"] =
      words.add<std::uint16_t>({0, 0, 0, 0, 65535, 0, 0, 0, 0, 13107, 0, 0}, kUShort, "VEC3", 3, true);
  words.json["bufferViews"].back()["byteStride"] = 8;
  expect_near(corner(load(words), 0, 1), {1, 0, 0});
  expect_near(corner(load(words), 0, 2), {0, 0.2F, 0});
}

TEST(GltfGeometry, ASparseAccessorReplacesSomeElements) {
  TinyGltf file;
  const int at = file.add_view(std::string("\x01", 1));
  const float moved[3] = {7, 8, 9};
  const int value = file.add_view(std::string(reinterpret_cast<const char*>(moved), sizeof moved));
  file.json["accessors"][0]["sparse"] = {
      {"count", 1}, {"indices", {{"bufferView", at}, {"componentType", kUByte}}}, {"values", {{"bufferView", value}}}};
  expect_near(load(file).meshes[0].positions[1], {7, 8, 9});
}

TEST(GltfGeometry, TransformsMultiplyDownTheHierarchy) {
  TinyGltf file;
  const double half = std::sqrt(0.5);
  file.json["nodes"] = {{{"translation", {10, 0, 0}}, {"children", {1, 2}}},
                        {{"rotation", {0, 0, half, half}}, {"scale", {2, 2, 2}}, {"mesh", 0}},
                        {{"matrix", {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 5, 1}}, {"mesh", 0}}};
  const Scene scene = load(file);
  ASSERT_EQ(scene.instances.size(), 2U);
  expect_near(corner(scene, 0, 1), {10, 2, 0});
  expect_near(corner(scene, 1, 1), {11, 0, 5});
  const traces::SceneInfo info = traces::scene_info(scene);
  EXPECT_EQ(info.triangles, 2U);
  EXPECT_EQ(info.stored_triangles, 1U);
  expect_near(traces::world_bounds(scene).upper, {11, 2, 5});
}

TEST(GltfGeometry, OneInstanceForEachNodeAndPrimitive) {
  TinyGltf file;
  file.json["meshes"][0]["primitives"].push_back(file.primitive());
  file.json["nodes"].push_back({{"mesh", 0}});
  file.json["scenes"][0]["nodes"] = {0, 1};
  const Scene scene = load(file);
  EXPECT_EQ(scene.meshes.size(), 2U);
  EXPECT_EQ(scene.instances.size(), 4U);
}

TEST(GltfGeometry, MeshesThatNoNodeShowsAreOmitted) {
  TinyGltf file;
  file.json["meshes"].push_back(file.json["meshes"][0]);
  EXPECT_EQ(load(file).meshes.size(), 1U);
}

TEST(GltfGeometry, WithoutScenesTheNodesWithoutParentsAreShown) {
  TinyGltf file;
  file.json.erase("scene");
  file.json.erase("scenes");
  EXPECT_EQ(load(file).instances.size(), 1U);
}

TEST(GltfGeometry, ANodeScaledToAPointIsLeftOutWithAWarning) {
  TinyGltf file;
  file.json["nodes"].push_back({{"mesh", 0}, {"scale", {0, 0, 0}}});
  file.json["scenes"][0]["nodes"] = {0, 1};
  const Scene scene = load(file);
  EXPECT_EQ(scene.instances.size(), 1U);
  ASSERT_EQ(scene.warnings.size(), 1U);
  EXPECT_SAYS(scene.warnings[0], "nodes[1] is scaled to a point and left out");
}

TEST(GltfGeometry, ANodeScaledToAPlaneOrALineIsShown) {
  for (const nlohmann::json& scale : {nlohmann::json{1, 1, 0}, {0, 2, 0}}) {
    TinyGltf file;
    file.node()["scale"] = scale;
    const Scene scene = load(file);
    EXPECT_EQ(scene.instances.size(), 1U);
    EXPECT_TRUE(scene.warnings.empty());
  }
}

TEST(GltfGeometry, SparseIndicesWithoutABufferViewReplaceZeros) {
  // Of 6 zeros, 1, 2, 4 and 5 become 1, 2, 2, 3: the triangles 0 1 2 and 0 2 3.
  TinyGltf file;
  file.primitive()["attributes"]["POSITION"] = file.add<float>({0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0}, kFloat, "VEC3", 4);
  const int at = file.add<std::uint8_t>({1, 2, 4, 5}, kUByte, "SCALAR", 4);
  const int values = file.add<std::uint16_t>({1, 2, 2, 3}, kUShort, "SCALAR", 4);
  const auto view = [&](int accessor) {
    return file.json["accessors"][static_cast<std::size_t>(accessor)]["bufferView"];
  };
  file.json["accessors"][1] = {{"componentType", kUShort},
                               {"type", "SCALAR"},
                               {"count", 6},
                               {"sparse",
                                {{"count", 4},
                                 {"indices", {{"bufferView", view(at)}, {"componentType", kUByte}}},
                                 {"values", {{"bufferView", view(values)}}}}}};
  const Scene scene = load(file);
  EXPECT_EQ(scene.meshes.at(0).positions.at(2), glm::vec3(1, 1, 0));
  EXPECT_EQ(scene.meshes[0].positions.at(3), glm::vec3(0)) << "flat normals: three vertices a triangle";
  EXPECT_EQ(scene.meshes[0].positions.at(5), glm::vec3(0, 1, 0));
}

TEST(GltfGeometry, PositionsOfAFileWithoutBuffersAreZeros) {
  TinyGltf file;
  for (const char* list : {"buffers", "bufferViews"}) file.json.erase(list);
  for (nlohmann::json& accessor : file.json["accessors"]) accessor.erase("bufferView");
  const Scene scene = load(file);
  EXPECT_EQ(scene.meshes.at(0).positions, std::vector<glm::vec3>(3, glm::vec3(0)));
}

TEST(GltfGeometry, AVeryDeepHierarchyIsNoProblem) {
  TinyGltf file;
  constexpr int kDepth = 90'000;
  file.json["nodes"] = nlohmann::json::array();
  for (int i = 0; i < kDepth; ++i) file.json["nodes"].push_back({{"children", {i + 1}}});
  file.json["nodes"].push_back({{"mesh", 0}});
  EXPECT_EQ(load(file).instances.size(), 1U);
}

TEST(GltfGeometry, FilesNextToTheGltfAreReadAndCountForTheDigest) {
  const TempFolder folder;
  TinyGltf file;
  file.json["buffers"][0]["uri"] = "the%20buffer.bin";
  folder.write("the buffer.bin", file.binary);
  const auto path = folder.write("a.gltf", file.text());
  const Scene first = traces::load_gltf(path);
  EXPECT_EQ(first.instances.size(), 1U);
  const float far = 4;
  std::memcpy(file.binary.data() + 12, &far, sizeof far);
  folder.write("the buffer.bin", file.binary);
  EXPECT_NE(first.sha256, traces::load_gltf(path).sha256);
}

}  // namespace
}  // namespace test
