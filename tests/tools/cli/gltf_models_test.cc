#include <gtest/gtest.h>

#include "tests/tools/program.h"

// Simulates conformance files of other programs.

namespace test {
namespace {

TEST(GltfModels, EveryTestModelOfAssimpIsRenderedOrRefusedInOneLine) {
  const std::filesystem::path folder = "/usr/share/assimp/models";
  if (!std::filesystem::is_directory(folder)) GTEST_SKIP() << "Debian's package assimp-testmodels is not installed";
  const TempFolder out;
  int rendered = 0, refused = 0;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
    const std::filesystem::path& path = entry.path();
    if ((path.extension() != ".glb" && path.extension() != ".gltf") || !entry.is_regular_file()) continue;
    if (path.parent_path().filename() == "Mesh_PrimitiveMode")
      continue;  // 16 near duplicates; the scene tests load them
    SCOPED_TRACE(path.string());
    const ProcessResult ending = raywatt(
        {"run", "--scene", path.string(), "--resolution", "16x8", "--force", "-o", (out.path() / "run").string()});
    if (ending.exit == 0) {
      ++rendered;
    } else {
      ++refused;
      expect_refusal(ending, {path.string()});
    }
  }
  EXPECT_GT(rendered, 10);
  EXPECT_GT(refused, 5);
}

}  // namespace
}  // namespace test
