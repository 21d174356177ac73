#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "sim/config/config.h"
#include "tests/tools/program.h"
#include "tools/run/frame/run_job.h"

// Tests of configuration keys for the BVH's number format and memory layout.

namespace test {
namespace {

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

}  // namespace
}  // namespace test
