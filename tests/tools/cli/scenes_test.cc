#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/tools/program.h"
#include "tests/traces/scene/feature_scene.h"
#include "tools/analysis/picture.h"
#include "traces/scene/export.h"
#include "traces/scene/images.h"
#include "traces/scenes/builtin.h"

// Tests of `raywatt scenes` with list, info and export.

namespace test {
namespace {

/// Scenes that are fast to build and export.
Words small_builtin_scenes() {
  Words names;
  for (const traces::BuiltinInfo& scene : traces::builtin_scenes()) {
    if (scene.triangles <= 60'000) names.push_back(scene.name);
  }
  return names;
}

std::string export_of(const std::string& scene, const std::filesystem::path& file) {
  const ProcessResult ending = raywatt({"scenes", "export", scene, "-o", file.string()});
  EXPECT_EQ(ending.exit, 0) << ending.err;
  return ending.out;
}

TEST(ScenesExport, GivesTheSamePicture) {
  const TempFolder folder;
  for (const std::string& scene : small_builtin_scenes()) {
    const std::filesystem::path file = folder.path() / (scene + ".glb");
    export_of(scene, file);
    const auto picture = [&](const std::string& which) {
      const std::filesystem::path out = folder.path() / "out";
      const ProcessResult ending = raywatt(small_run(out, {"--scene", which, "--quiet"}));
      EXPECT_EQ(ending.exit, 0) << ending.err;
      return traces::read_exr(out / "image.exr").rgb;
    };
    const double error = tools::mean_squared_error(picture(scene), picture(file.string()));
    EXPECT_GT(tools::psnr_db(error).value_or(200), 70) << scene;
  }
}

TEST(ScenesExport, ReplacesAFileOnlyIfForced) {
  const TempFolder folder;
  const std::string file = folder.write("mine.glb", "precious").string();
  expect_refusal(raywatt({"scenes", "export", "cornell", "-o", file}), {"mine.glb exists", "--force"});
  EXPECT_EQ(read_bytes(file), "precious");
  EXPECT_EQ(raywatt({"scenes", "export", "cornell", "-o", file, "--force"}).exit, 0);
  EXPECT_TRUE(read_bytes(file).starts_with("glTF"));
  EXPECT_EQ(names_in(folder.path()), Words{"mine.glb"});
}

TEST(ScenesExport, NeedsAnOutputThatEndsWithGlb) {
  expect_refusal(raywatt({"scenes", "export", "cornell"}), {"--output"});
  const TempFolder folder;
  expect_refusal(raywatt({"scenes", "export", "cornell", "-o", (folder.path() / "a.obj").string()}), {".glb"});
  const ProcessResult ending =
      raywatt({"scenes", "export", "cornell", "-o", (folder.path() / "none" / "a.glb").string()});
  EXPECT_EQ(ending.exit, 2) << ending.err;
  EXPECT_TRUE(names_in(folder.path()).empty());
}

TEST(ScenesInfo, JsonCountsWhatIsThere) {
  const ProcessResult ending = raywatt({"scenes", "info", "cornell", "--json"});
  ASSERT_EQ(ending.exit, 0) << ending.err;
  const nlohmann::json info = nlohmann::json::parse(ending.out);
  EXPECT_EQ(info["schema"], "raywatt-scene/1");
  EXPECT_EQ(info["cameras"][0]["name"], "front");
  EXPECT_EQ(info["animation"]["tracks"], 2) << "the camera's path and turns";
  std::uint64_t parts = 0;
  for (const auto& part : info["memory_image"]["parts"].items()) parts += part.value().get<std::uint64_t>();
  EXPECT_EQ(info["memory_image"]["bytes"], parts);
  EXPECT_EQ(info["bvh"]["leaves"].get<int>(), info["bvh"]["nodes"].get<int>() + 1);
  EXPECT_GT(info["host"]["peak_bytes"], 0);
  EXPECT_EQ(info["host"]["file_bytes"], 0);
}

TEST(ScenesInfo, GivesTheBytesOfNodesInEachFormatAndInTheChosenOne) {
  const auto info = [](const Words& more) {
    Words words = {"scenes", "info", "teapot", "--json"};
    words.insert(words.end(), more.begin(), more.end());
    return nlohmann::json::parse(raywatt(words).out);
  };
  const nlohmann::json standard = info({});
  const std::uint64_t nodes = standard["bvh"]["nodes"];
  const nlohmann::json formats = {{"fp32 pair", 64 * nodes},
                                  {"fp32 single", 32 * (2 * nodes + 1)},
                                  {"hybrid pair", 40 * nodes},
                                  {"hybrid single", 20 * (2 * nodes + 1)}};
  EXPECT_EQ(standard["memory_image"]["nodes_by_format"], formats);
  EXPECT_EQ(standard["memory_image"]["parts"]["nodes"], formats["fp32 pair"]);
  EXPECT_EQ(info({"--set", "bvh.numbers=hybrid"})["memory_image"]["parts"]["nodes"], formats["hybrid pair"]);
}

TEST(ScenesInfo, DescribesFourTriangles) {
  const TempFolder folder;
  // A tetrahedron with corners (0,0,0), (1,0,0), (0,1,0), (0,0,1).
  const std::string file =
      folder
          .write("four.gltf", R"({"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}],
"nodes": [{"mesh": 0}], "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
"accessors": [
  {"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3", "min": [0, 0, 0], "max": [1, 1, 1]},
  {"bufferView": 1, "componentType": 5121, "count": 12, "type": "SCALAR"}],
"bufferViews": [
  {"buffer": 0, "byteOffset": 0, "byteLength": 48}, {"buffer": 0, "byteOffset": 48, "byteLength": 12}],
"buffers": [{"byteLength": 60,
  "uri": "data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAAAAAAAAAAAAAAAIA/AAIBAAEDAAMCAQID"}]})")
          .string();
  const ProcessResult ending = raywatt({"scenes", "info", file});
  ASSERT_EQ(ending.exit, 0) << ending.err;
  EXPECT_SAYS(ending.out, "triangles         4\n");
  EXPECT_SAYS(ending.out, "BVH               1 node, 1 leaf, depth 1");
  EXPECT_EQ(ending.out.find("nan"), std::string::npos) << ending.out;
}

TEST(ScenesInfo, CountsMotionTexturesAndTheFile) {
  const TempFolder folder;
  const std::string file = folder.write("features.glb", traces::export_glb(feature_scene())).string();
  const ProcessResult ending = raywatt({"scenes", "info", file, "--json"});
  ASSERT_EQ(ending.exit, 0) << ending.err;
  const nlohmann::json info = nlohmann::json::parse(ending.out);
  EXPECT_EQ(info["host"]["file_bytes"], std::filesystem::file_size(file));
  EXPECT_EQ(info["triangles"], 14);
  EXPECT_GT(info["textures"]["bytes"], 0);
  EXPECT_EQ(info["animation"]["duration_s"], 2);
  EXPECT_EQ(info["animation"]["tracks"], 5);
  EXPECT_EQ(info["animation"]["skins"], 1);
  EXPECT_EQ(info["animation"]["morph_targets"], 2);
  EXPECT_EQ(info["animation"]["moving_instances"], 5) << "all but the two boards";
}

TEST(ScenesInfo, ShowsThePlacesOfCamerasOnRequest) {
  EXPECT_SAYS(raywatt({"scenes", "info", "cornell", "--camera"}).out, "'front' at (0, 0, 3.4), direction (");
  EXPECT_EQ(raywatt({"scenes", "info", "cornell"}).out.find("direction"), std::string::npos);
}

TEST(ScenesHelp, OfEverySubVerbHasItsOwnExample) {
  for (const auto& [verb, subs] : {std::pair{"scenes", Words{"list", "info", "export"}},
                                   {"config", Words{"list", "show", "schema", "manual"}},
                                   {"kernels", Words{"list", "show"}}}) {
    for (const std::string& sub : subs) {
      EXPECT_SAYS(raywatt({verb, sub, "--help"}).out, std::string("Example: raywatt ") + verb + " " + sub);
    }
  }
}

}  // namespace
}  // namespace test
