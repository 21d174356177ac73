#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "sim/error.h"
#include "tests/real_scenes.h"
#include "traces/scene/gltf.h"
#include "traces/scene/info.h"

namespace test {
namespace {

void try_all(const std::filesystem::path& folder) {
  int tried = 0;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
    const bool is_gltf = entry.path().extension() == ".glb" || entry.path().extension() == ".gltf";
    if (!is_gltf || !entry.is_regular_file()) continue;
    SCOPED_TRACE(entry.path().string());
    ++tried;
    try {
      const traces::Scene scene = traces::load_gltf(entry.path());
      EXPECT_GT(traces::scene_info(scene).triangles, 0U);
      EXPECT_FALSE(scene.cameras.empty());
      EXPECT_FALSE(scene.lights.empty());
      for (const traces::Light& light : scene.lights) {
        EXPECT_TRUE(std::isfinite(light.intensity.x) &&
                    std::max({light.intensity.x, light.intensity.y, light.intensity.z}) > 0);
      }
      for (const traces::Mesh& mesh : scene.meshes) {
        ASSERT_EQ(mesh.normals.size(), mesh.positions.size());
        const bool all_unit =
            std::ranges::all_of(mesh.normals, [](const glm::vec3& n) { return std::abs(glm::length(n) - 1) < 1e-4F; });
        EXPECT_TRUE(all_unit) << mesh.name;
      }
    } catch (const sim::InputError& error) {
      EXPECT_NE(std::string(error.what()), "");
      std::cout << "refused: " << error.what() << '\n';
    }
  }
  EXPECT_GT(tried, 0) << "the folder holds no .glb or .gltf file";
}

TEST(SceneFolder, EveryFileLoadsOrIsRefusedWithAReason) {
  const std::filesystem::path folder = scenes_folder();
  if (!std::filesystem::is_directory(folder)) {
    GTEST_SKIP() << "no scenes in " << folder << "; set RAYWATT_SCENES to a folder of .glb files to try them";
  }
  try_all(folder);
}

TEST(SceneFolder, EveryTestModelOfAssimpLoadsOrIsRefusedWithAReason) {
  const std::filesystem::path folder = "/usr/share/assimp/models";
  if (!std::filesystem::is_directory(folder)) GTEST_SKIP() << "Debian's package assimp-testmodels is not installed";
  try_all(folder);
}

}  // namespace
}  // namespace test
