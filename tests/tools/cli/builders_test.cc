#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "sim/config/config.h"
#include "sim/io/file.h"
#include "tests/tools/program.h"
#include "tools/run/frame/run_job.h"

// Tests of bvh.builder through the program: pictures, verification, traces, keys, quality.

namespace test {
namespace {

TEST(TreeBuilders, GiveTheSamePictureAndAgreeWithEmbree) {
  const TempFolder folder;
  for (const Words& scene :
       std::vector<Words>{{"--scene", "cornell"},
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

// Tests of configuration keys for the BVH's number format and memory layout.

tools::Inputs inputs_of(const std::vector<std::string>& sets) {
  tools::JobOptions options;
  options.scene = "cornell";
  options.resolution = "64x32";
  options.threads = 1;
  options.sets = sets;
  return tools::load_inputs(options);
}

tools::FrameResult run(const tools::Inputs& inputs) {
  return tools::simulate_frame(inputs, kernels::parse_program("full:1"), 1);
}

/// Returns every key that affects the layout, with a value other than the default.
std::vector<std::string> layout_changes() {
  std::vector<std::string> changes;
  for (const sim::FieldInfo& field : sim::list_fields(tools::RunConfig())) {
    if (field.affects != sim::Affects::kLayout) continue;
    if (field.choices.empty()) changes.push_back(field.path + "=" + std::to_string(static_cast<int>(field.limits.min)));
    for (const std::string& choice : field.choices) {
      if (choice != field.value) changes.push_back(field.path + "=" + choice);
    }
  }
  return changes;
}

TEST(LayoutKeys, MoveAddressesAndChangeNothingOfTheWork) {
  const tools::Inputs standard = inputs_of({});
  const tools::FrameResult expected = run(standard);
  ASSERT_EQ(layout_changes(), (std::vector<std::string>{"bvh.boxes=single", "bvh.triangle_bytes=36"}));
  for (const std::string& change : layout_changes()) {
    SCOPED_TRACE(change);
    const tools::Inputs inputs = inputs_of({change});
    EXPECT_EQ(inputs.bvh_hash, standard.bvh_hash);
    EXPECT_NE(sim::config_hash(inputs.config, sim::Affects::kLayout),
              sim::config_hash(standard.config, sim::Affects::kLayout));
    EXPECT_NE(inputs.image.layout.attributes, standard.image.layout.attributes);
    const tools::FrameResult moved = run(inputs);
    EXPECT_EQ(moved.rendered.rgb, expected.rendered.rgb);
    EXPECT_EQ(moved.rays(), expected.rays());
    EXPECT_EQ(moved.rendered.traversal_steps, expected.rendered.traversal_steps);
  }
}

TEST(HybridNumbers, AreAnotherTreeAndNoOtherPicture) {
  const tools::Inputs floats = inputs_of({}), hybrid = inputs_of({"bvh.numbers=hybrid"});
  EXPECT_NE(hybrid.bvh_hash, floats.bvh_hash);
  EXPECT_NE(sim::config_hash(hybrid.config, sim::Affects::kFunction),
            sim::config_hash(floats.config, sim::Affects::kFunction));
  EXPECT_EQ(run(hybrid).rendered.rgb, run(floats).rendered.rgb);
}

TEST(HybridNumbers, AgreeWithEmbreeRayForRayInMovingScenesToo) {
  const TempFolder folder;
  const auto verified = [&](Words words) {
    words.insert(words.begin(), "verify");
    words.insert(words.end(), {"--resolution", "128x64", "--quiet", "-o", folder.path().string()});
    const ProcessResult ending = raywatt(words);
    EXPECT_EQ(ending.exit, 0) << ending.err;
    const nlohmann::json verdict = read_json(folder.path() / "verify.json");
    EXPECT_GT(verdict["rays"], 1000);
    return verdict["missing_hits"] == 0 && verdict["extra_hits"] == 0 && verdict["distance_errors"] == 0;
  };
  for (const char* scene : {"cornell", "teapot", "atrium"}) {
    EXPECT_TRUE(verified({"--scene", scene, "--set", "bvh.numbers=hybrid"})) << scene;
  }
  EXPECT_TRUE(
      verified({"--scene", "chess", "--frames", "1:3", "--set", "bvh.numbers=hybrid", "--set", "bvh.update=refit"}));
}

TEST(TriangleBytes, Are36Or48) {
  const TempFolder folder;
  expect_refusal(raywatt(small_run(folder.path() / "out", {"--set", "bvh.triangle_bytes=40"})),
                 {"bvh.triangle_bytes", "36 or 48"});
}

// Tests of wide trees through the program: pictures, verification, traces, keys, sizes.

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
  for (const Words& scene :
       std::vector<Words>{{"--scene", "cornell"},
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
