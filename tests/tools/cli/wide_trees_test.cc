#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "sim/io/file.h"
#include "tests/tools/program.h"

// Tests of wide trees through the program: pictures, verification, traces, keys, sizes.

namespace test {
namespace {

const std::vector<Words> kForms = {
    {"--set", "bvh.width=4"},
    {"--set", "bvh.width=6", "--set", "bvh.collapse=sah"},
    {"--set", "bvh.width=8", "--set", "bvh.format=q8", "--set", "bvh.leaf=pair64"},
    {"--set", "bvh.width=8", "--set", "bvh.format=q12", "--set", "bvh.leaf=block128"},
    {"--set", "bvh.width=8", "--set", "bvh.format=cw80", "--set", "bvh.leaf_size=3"},
    {"--set", "bvh.width=4", "--set", "bvh.format=hybrid"},
};

std::string text_of(const Words& words) {
  std::string text;
  for (const std::string& word : words) text += word + " ";
  return text;
}

/// Runs a verb on a small picture and returns its folder.
std::filesystem::path made_by(const TempFolder& folder, Words words, const Words& more) {
  static int number = 0;
  const std::filesystem::path out = folder.path() / std::to_string(number++);
  words.insert(words.end(), {"--resolution", "32x16", "--quiet", "-o", out.string()});
  words.insert(words.end(), more.begin(), more.end());
  const ProcessResult ending = raywatt(words);
  EXPECT_EQ(ending.exit, 0) << ending.err;
  return out;
}

TEST(WideTrees, GiveTheSamePictureAndAgreeWithEmbree) {
  const TempFolder folder;
  for (const Words& scene : std::vector<Words>{
           {"--scene", "cornell"},
           {"--scene", "forest", "--set", "bvh.instances=two_level", "--set", "scene.triangles=5000"}}) {
    Words verify = {"verify"};
    verify.insert(verify.end(), scene.begin(), scene.end());
    const std::string expected = read_bytes(made_by(folder, verify, {}) / "image.png");
    for (const Words& form : kForms) {
      SCOPED_TRACE(text_of(scene) + text_of(form));
      if (scene.size() > 2 && form.back() == "bvh.format=hybrid") continue;
      const std::filesystem::path out = made_by(folder, verify, form);
      EXPECT_EQ(read_bytes(out / "image.png"), expected);
      const nlohmann::json verdict = read_json(out / "verify.json");
      EXPECT_EQ(verdict["missing_hits"], 0);
      EXPECT_EQ(verdict["extra_hits"], 0);
      EXPECT_EQ(verdict["distance_errors"], 0);
    }
  }
}

TEST(WideTrees, AreReplayedAsTheyAreSimulated) {
  const TempFolder folder;
  for (const Words& form : kForms) {
    SCOPED_TRACE(text_of(form));
    const std::string trace = (folder.path() / "a.trace").string();
    Words record = {"trace", "record", trace, "--resolution", "16x16", "--quiet"};
    record.insert(record.end(), form.begin(), form.end());
    const ProcessResult ending = raywatt(record);
    ASSERT_EQ(ending.exit, 0) << ending.err;
    EXPECT_EQ(raywatt({"trace", "info", trace}).exit, 0);
    const std::filesystem::path replayed = folder.path() / "r", simulated = folder.path() / "out";
    const ProcessResult replay = raywatt({"trace", "replay", trace, "-o", replayed.string(), "--force"});
    ASSERT_EQ(replay.exit, 0) << replay.err;
    Words words = {"run", "--resolution", "16x16", "--quiet", "--force", "-o", simulated.string()};
    words.insert(words.end(), form.begin(), form.end());
    const ProcessResult run = raywatt(words);
    ASSERT_EQ(run.exit, 0) << run.err;
    EXPECT_EQ(read_json(replayed / "report.json")["units"], read_json(simulated / "report.json")["units"]);
  }
}

TEST(WideTrees, HaveOnlyKeysThatFitTogether) {
  const auto refused = [](const Words& sets, const Words& parts) {
    Words words = {"config", "show"};
    for (const std::string& set : sets) words.insert(words.end(), {"--set", set});
    expect_refusal(raywatt(words), parts);
  };
  refused({"bvh.width=3"}, {"bvh.width", "2, 4, 6, 8"});
  refused({"bvh.width=16"}, {"bvh.width", "out of range"});
  refused({"bvh.width=4", "bvh.boxes=single"}, {"bvh.boxes", "pair"});
  refused({"bvh.format=q8", "bvh.numbers=hybrid"}, {"bvh.numbers", "fp32"});
  refused({"bvh.format=q12", "bvh.triangle_bytes=36"}, {"bvh.triangle_bytes", "48"});
  refused({"bvh.format=cw80"}, {"bvh.leaf_size", "1 to 3"});
  refused({"bvh.format=q8", "bvh.leaf_size=8"}, {"bvh.leaf_size", "1 to 7"});
  refused({"bvh.width=8", "bvh.order=octant"}, {"bvh.order", "cw80"});
  refused({"bvh.format=hybrid", "bvh.instances=two_level"}, {"bvh.format", "fp32"});
}

TEST(WideTrees, AreListedWithTheirSizesByScenesInfo) {
  const ProcessResult ending = raywatt({"scenes", "info", "cornell", "--json"});
  ASSERT_EQ(ending.exit, 0) << ending.err;
  const nlohmann::json info = nlohmann::json::parse(ending.out);
  const auto row = [&](int width, const char* format) {
    for (const auto& tree : info["trees"]) {
      if (tree["width"] == width && tree["format"] == format) return tree;
    }
    ADD_FAILURE() << width << " " << format;
    return nlohmann::json{};
  };
  EXPECT_EQ(row(2, "fp32")["nodes"], info["bvh"]["nodes"]);
  EXPECT_EQ(row(2, "fp32")["sah_cost"], info["bvh"]["sah_cost"]);
  EXPECT_EQ(row(2, "fp32")["mean_children"], 2.0);
  for (const int width : {4, 6, 8}) {
    const nlohmann::json tree = row(width, "fp32"), quantised = row(width, "q8");
    EXPECT_EQ(tree["leaves"], info["bvh"]["leaves"]);
    EXPECT_EQ(quantised["nodes"], tree["nodes"]);
    EXPECT_GT(quantised["sah_cost"], tree["sah_cost"]);
    EXPECT_LT(quantised["sah_cost"].get<double>(), 1.12 * tree["sah_cost"].get<double>());
    EXPECT_LT(quantised["bytes_per_triangle"], tree["bytes_per_triangle"]);
  }
  const ProcessResult wide = raywatt({"scenes", "info", "cornell", "--set", "bvh.width=8", "--set", "bvh.format=q8"});
  ASSERT_EQ(wide.exit, 0) << wide.err;
  EXPECT_SAYS(wide.out, "8 q8");
}

}  // namespace
}  // namespace test
