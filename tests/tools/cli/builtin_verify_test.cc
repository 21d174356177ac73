#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <span>
#include <string>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "sim/io/file.h"
#include "tests/full_size.h"
#include "tests/tools/program.h"
#include "traces/scene/images.h"
#include "traces/scenes/builtin.h"

namespace test {
namespace {

class BuiltIn : public testing::TestWithParam<std::string> {};

traces::Texture read_png(const std::filesystem::path& file) {
  const std::string bytes = sim::read_file(file, 1 << 20);
  return traces::read_image(std::as_bytes(std::span(bytes)), file.string());
}

/// Counts pixels with a channel that differs by more than one 8-bit step. Glass amplifies the last bits of distances,
/// and Embree's depend on the host's reciprocal estimates.
std::size_t pixels_that_differ(const std::filesystem::path& a, const std::filesystem::path& b) {
  const traces::Texture one = read_png(a), other = read_png(b);
  std::size_t differ = 0;
  for (std::size_t i = 0; i < one.texels.size(); ++i) {
    int most = 0;
    for (int shift = 0; shift < 24; shift += 8) {
      const auto channel = [&](std::uint32_t texel) { return static_cast<int>(texel >> shift & 0xffU); };
      most = std::max(most, std::abs(channel(one.texels[i]) - channel(other.texels[i])));
    }
    differ += most > 1;
  }
  return differ;
}

/// Small pictures of small scenes, or of all scenes at full size. The hairball has an eighth of its strands.
TEST_P(BuiltIn, AgreesWithEmbreeRayForRayAndInItsPicture) {
  const TempFolder folder;
  Words words = {"verify", "--scene", GetParam(), "--resolution", "200x100", "--quiet", "-o", folder.path().string()};
  if (GetParam() == "hairball") words.insert(words.end(), {"--set", "scene.triangles=360000"});
  const ProcessResult ending = raywatt(words);
  ASSERT_EQ(ending.exit, 0) << ending.err;
  const nlohmann::json verdict = read_json(folder.path() / "verify.json");
  EXPECT_EQ(verdict["missing_hits"], 0);
  EXPECT_EQ(verdict["extra_hits"], 0);
  EXPECT_EQ(verdict["distance_errors"], 0);
  EXPECT_LE(pixels_that_differ(folder.path() / "image.png", folder.path() / "embree.png"), 200 * 100 / 1000)
      << verdict["psnr_db"];
}

std::vector<std::string> names() {
  std::vector<std::string> all;
  for (const traces::BuiltinInfo& scene : traces::builtin_scenes()) {
    if (scene.triangles <= full_or(10'000'000U, 60'000U)) all.push_back(scene.name);
  }
  return all;
}

INSTANTIATE_TEST_SUITE_P(Scenes, BuiltIn, testing::ValuesIn(names()), [](const auto& test) { return test.param; });

// Simulates conformance files of other programs.

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
