#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "tests/tools/program.h"
#include "tests/traces/scene/tiny_gltf_file.h"

// Tests that invalid scenes cause one line on stderr with the file's name, exit code 2 and no output.

namespace test {
namespace {

/// Expects the verb to fail without creating the output folder or its parent.
void expect_scene_refused(const TempFolder& folder, const std::string& scene, const Words& parts) {
  const Words before = names_in(folder.path());
  for (const char* verb : {"run", "verify"}) {
    expect_refusal(raywatt({verb, "--scene", scene, "-o", (folder.path() / "new" / "out").string()}), parts);
  }
  expect_refusal(raywatt({"scenes", "info", scene}), parts);
  EXPECT_EQ(names_in(folder.path()), before);
}

void expect_file_refused(const std::string& name, const std::string& bytes, Words parts) {
  const TempFolder folder;
  const std::string scene = folder.write(name, bytes).string();
  parts.push_back(scene);
  expect_scene_refused(folder, scene, parts);
}

TEST(BadScene, ATruncatedGlb) {
  const std::string whole = TinyGltf().glb();
  expect_file_refused("cut.glb", whole.substr(0, whole.size() / 2), {"bytes"});
  expect_file_refused("nearly.glb", whole.substr(0, whole.size() - 4), {"bytes"});
}

TEST(BadScene, AnEmptyFile) { expect_file_refused("empty.glb", "", {"empty"}); }

TEST(BadScene, AFileThatIsNoGltf) { expect_file_refused("hello.gltf", "hello", {"line 1, column 1"}); }

TEST(BadScene, APictureWithTheNameOfAScene) {
  expect_file_refused("a.glb", "\x89PNG\r\n\x1a\n more",
                      {"is a PNG picture, not a glTF scene; allowed: .glb and .gltf"});
  expect_file_refused("a.gltf", "\xff\xd8\xff\xe0 more", {"is a JPEG picture, not a glTF scene"});
}

TEST(BadScene, AFileLargerThanTheLimitGetsTheLimitsKey) {
  const TempFolder folder;
  const std::string scene = folder.write("large.gltf", TinyGltf().text() + std::string(1 << 20, ' ')).string();
  expect_refusal(
      raywatt({"run", "--scene", scene, "--set", "limits.memory=1 MiB", "-o", (folder.path() / "o").string()}),
      {scene, "bytes, more than limits.memory, 1 MiB; allowed: a larger one, e.g. --set limits.memory='8 GiB'"});
  expect_refusal(
      raywatt({"run", "--scene", scene, "--set", "limits.memory=2 MiB", "-o", (folder.path() / "o").string()}),
      {scene, "more than is left of the limit of 2 MiB; allowed: a larger limits.memory"});
}

TEST(BadScene, AMissingTexture) {
  TinyGltf file;
  file.json["images"] = {{{"uri", "nowhere.png"}}};
  file.json["textures"] = {{{"source", 0}}};
  file.material()["pbrMetallicRoughness"]["baseColorTexture"]["index"] = 0;
  file.primitive()["attributes"]["TEXCOORD_0"] = file.add<float>({0, 0, 1, 0, 0, 1}, kFloat, "VEC2", 3);
  expect_file_refused("bare.gltf", file.text(), {"nowhere.png"});
}

TEST(BadScene, AMissingBuffer) {
  TinyGltf file;
  file.json["buffers"][0]["uri"] = "nowhere.bin";
  expect_file_refused("bare.gltf", file.text(), {"nowhere.bin"});
}

TEST(BadScene, NoTriangles) {
  TinyGltf file;
  file.json["nodes"][0].erase("mesh");
  expect_file_refused("none.gltf", file.text(), {"no triangles"});
}

TEST(BadScene, VerticesThatAreNoNumbers) {
  TinyGltf file;
  const float nan = std::numeric_limits<float>::quiet_NaN();
  std::memcpy(file.binary.data() + 4, &nan, sizeof nan);
  expect_file_refused("nan.glb", file.glb(), {"not a finite number"});
}

TEST(BadScene, AFileThatIsNotThere) {
  const TempFolder folder;
  expect_scene_refused(folder, (folder.path() / "nowhere.glb").string(), {"nowhere.glb", "no such file"});
}

TEST(BadScene, AFolder) {
  const TempFolder folder;
  expect_scene_refused(folder, folder.path().string() + "/", {"is a folder"});
}

TEST(BadScene, AnUnknownNameGetsTheNearestOne) {
  const TempFolder folder;
  expect_scene_refused(folder, "teapott", {"'teapott'", "did you mean 'teapot'"});
  expect_scene_refused(folder, "zzzzzz", {"'zzzzzz'", "cornell", "teapot"});
}

TEST(BadScene, AnUnknownCameraIsAnsweredWithTheKnownOnes) {
  const TempFolder folder;
  for (const char* camera : {"rear", "7", "-1"}) {
    expect_refusal(raywatt({"run", "--camera", camera, "-o", (folder.path() / "out").string()}),
                   {"cornell", camera, "0 'front'"});
  }
  EXPECT_EQ(names_in(folder.path()), Words{});
}

}  // namespace
}  // namespace test
