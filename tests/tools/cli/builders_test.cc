#include <string>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "sim/io/file.h"
#include "tests/tools/program.h"

// Tests of bvh.builder through the program: pictures, verification, traces, keys, quality.

namespace test {
namespace {

TEST(TreeBuilders, GiveTheSamePictureAndAgreeWithEmbree) {
  const TempFolder folder;
  for (const Words& scene : std::vector<Words>{
           {"--scene", "cornell"},
           {"--scene", "forest", "--set", "bvh.instances=two_level", "--set", "scene.triangles=5000"}}) {
    std::string expected;
    for (const std::string builder : {"embree", "lbvh", "ploc"}) {
      SCOPED_TRACE(scene[1] + " " + builder);
      const std::filesystem::path out = folder.path() / (scene[1] + builder);
      Words words = {"verify", "--resolution", "32x16", "--quiet",
                     "-o",     out.string(),   "--set", "bvh.builder=" + builder};
      words.insert(words.end(), scene.begin(), scene.end());
      const ProcessResult ending = raywatt(words);
      ASSERT_EQ(ending.exit, 0) << ending.err;
      const std::string picture = read_bytes(out / "image.png");
      if (expected.empty()) expected = picture;
      EXPECT_EQ(picture, expected);
      const nlohmann::json verdict = read_json(out / "verify.json");
      EXPECT_EQ(verdict["missing_hits"], 0);
      EXPECT_EQ(verdict["extra_hits"], 0);
      EXPECT_EQ(verdict["distance_errors"], 0);
    }
  }
}

TEST(TreeBuilders, AreReplayedFromTraces) {
  const TempFolder folder;
  const std::string trace = (folder.path() / "a.trace").string();
  const ProcessResult record = raywatt({"trace", "record", trace, "--resolution", "16x16", "--quiet", "--set",
                                        "bvh.builder=ploc", "--set", "bvh.ploc_radius=8"});
  ASSERT_EQ(record.exit, 0) << record.err;
  const std::filesystem::path replayed = folder.path() / "r";
  const ProcessResult replay = raywatt({"trace", "replay", trace, "-o", replayed.string()});
  ASSERT_EQ(replay.exit, 0) << replay.err;
  const auto config = read_json(replayed / "report.json")["config"];
  EXPECT_EQ(config["bvh"]["builder"], "ploc");
  EXPECT_EQ(config["bvh"]["ploc_radius"], 8);
}

TEST(TreeBuilders, HaveOnlyCodesAndRadiiOfPublishedBuilders) {
  const auto refused = [](const std::string& set, const Words& parts) {
    expect_refusal(raywatt({"config", "show", "--set", set}), parts);
  };
  refused("bvh.builder=sah", {"bvh.builder", "embree, lbvh, ploc"});
  refused("bvh.morton_bits=32", {"bvh.morton_bits", "24, 30, 63"});
  refused("bvh.ploc_radius=12", {"bvh.ploc_radius", "8, 16"});
}

TEST(TreeBuilders, AreComparedByScenesInfo) {
  const ProcessResult ending = raywatt({"scenes", "info", "cornell", "--json", "--set", "bvh.builder=lbvh"});
  ASSERT_EQ(ending.exit, 0) << ending.err;
  const nlohmann::json info = nlohmann::json::parse(ending.out), &rows = info["builders"];
  ASSERT_EQ(rows.size(), 3U);
  const nlohmann::json &embree = rows[0], &lbvh = rows[1], &ploc = rows[2];
  EXPECT_EQ(embree["builder"], "embree");
  EXPECT_EQ(lbvh["sah_cost"], info["bvh"]["sah_cost"]);
  EXPECT_GT(lbvh["sah_cost"], ploc["sah_cost"]);
  EXPECT_GT(lbvh["sah_cost"], embree["sah_cost"]);
  EXPECT_EQ(lbvh["rounds"], 0);
  EXPECT_GT(ploc["rounds"], 10);
  for (const char* kind : {"primary", "diffuse", "shadow"}) {
    EXPECT_GT(lbvh[kind]["visits"], embree[kind]["visits"]);
    for (const nlohmann::json& row : rows) EXPECT_GT(row[kind]["tests"], 0);
  }
  EXPECT_SAYS(raywatt({"scenes", "info", "cornell"}).out, "ploc");
}

}  // namespace
}  // namespace test
