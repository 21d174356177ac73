#include <algorithm>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "shader_kernels/catalogue.h"
#include "sim/error.h"
#include "tests/hw_models/machines/gpu_harness.h"
#include "tools/run/frame/run_job.h"

// Tests of runs that charge the machine for the trees of moving scenes.

namespace tools {
namespace {

JobOptions options_of(const std::string& scene, std::vector<std::string> sets, const std::string& frames = "0:3") {
  JobOptions options;
  options.scene = scene;
  options.program = "full:1";
  options.resolution = "32x16";
  options.frames = frames;
  options.sets = {"render.tile=16"};
  if (scene != "cornell") options.sets.emplace_back("scene.triangles=3000");
  options.sets.insert(options.sets.end(), sets.begin(), sets.end());
  options.threads = 1;
  return options;
}

/// Returns a letter per frame of a run: b if its trees are built, r if one is refitted, - if nothing is charged.
std::string builds_of(const JobOptions& options) {
  Inputs inputs = load_inputs(options);
  std::string letters;
  for_each_frame(inputs, 1, nullptr, [&] {
    bool refits = false;
    for (const traces::TreeBuild& build : inputs.builds.trees) refits |= build.job.refit;
    letters += inputs.builds.trees.empty() ? '-' : refits ? 'r' : 'b';
  });
  return letters;
}

TEST(BuiltFrames, AreRebuiltOrRefittedByPolicy) {
  for (const char* engine : {"build.engine=unit", "build.engine=srp"}) {
    const auto with = [&](const std::vector<std::string>& sets) {
      std::vector<std::string> all = {engine};
      all.insert(all.end(), sets.begin(), sets.end());
      return builds_of(options_of("car", all));
    };
    EXPECT_EQ(with({}), "bbbb");
    EXPECT_EQ(with({"bvh.update=refit"}), "brrr");
    EXPECT_EQ(with({"build.policy=rebuild", "bvh.update=refit"}), "bbbb");
    EXPECT_EQ(with({"build.policy=refit"}), "brrr");
    EXPECT_EQ(with({"build.policy=period", "build.period=2"}), "brbr");
    EXPECT_EQ(with({"build.policy=cost", "build.cost_growth=1000"}), "brrr");
  }
  EXPECT_EQ(builds_of(options_of("car", {"build.engine=unit", "build.policy=period", "build.period=2"}, "3:4")), "bb")
      << "the first frame of a run is built";
}

TEST(BuiltFrames, ChargeOnlyMovingGeometry) {
  EXPECT_EQ(builds_of(options_of("car", {}, "0:1")), "--") << "the host builds";
  EXPECT_EQ(builds_of(options_of("cornell", {"build.engine=unit", "scene.camera_path=orbit"}, "0:1")), "--");
}

FrameResult first_frame(const JobOptions& options) {
  return simulate_frame(load_inputs(options), kernels::parse_program(options.program), 1);
}

hw::test::Outcome outcome_of(const FrameResult& s) { return {s.units, s.kernel_use, {}, s.elapsed, s.cycles}; }

TEST(BuiltFrames, CostTimeAndEnergyOfTheirEngine) {
  const FrameResult host = first_frame(options_of("car", {}, "0"));
  const FrameResult unit = first_frame(options_of("car", {"build.engine=unit"}, "0"));
  const FrameResult srp = first_frame(options_of("car", {"build.engine=srp"}, "0"));
  EXPECT_GT(unit.cycles, host.cycles);
  EXPECT_GT(srp.cycles, host.cycles);
  EXPECT_FALSE(host.energy.blocks.contains("build"));
  EXPECT_FALSE(srp.energy.blocks.contains("build"));
  ASSERT_TRUE(unit.energy.blocks.contains("build"));
  EXPECT_GT(unit.energy.blocks.at("build").dynamic.nominal, 0);
  EXPECT_GT(outcome_of(unit).sum("tree_builder", "tree_bytes_written"), 48U * 1000);
  EXPECT_EQ(host.rendered.rgb, unit.rendered.rgb);
  EXPECT_EQ(host.rendered.rgb, srp.rendered.rgb);
}

TEST(BuiltFrames, PoseGeometryByKernelsWithAnyEngine) {
  for (const char* engine : {"build.engine=unit", "build.engine=srp"}) {
    const auto launched_items = [&](const std::string& scene, const char* kernel) {
      const FrameResult frame = first_frame(options_of(scene, {engine, "bvh.instances=two_level"}, "0"));
      return frame.kernel_use.at(kernels::find_kernel(kernel)->id).items;
    };
    EXPECT_GT(launched_items("crowd", "skin_vertex"), 1000U) << engine;
    // The tree builder writes instances itself.
    EXPECT_EQ(launched_items("car", "pose_instance") > 0, engine == std::string_view("build.engine=srp"));
  }
  const FrameResult flat = first_frame(options_of("car", {"build.engine=unit"}, "0"));
  EXPECT_GT(flat.kernel_use.at(kernels::find_kernel("pose_vertex")->id).items, 100U);
}

TEST(BuiltFrames, InvalidateWarmCaches) {
  const FrameResult cold = first_frame(options_of("car", {"build.engine=unit"}, "0"));
  const FrameResult warm = first_frame(options_of("car", {"build.engine=unit", "frame.start=warm"}, "0"));
  EXPECT_EQ(outcome_of(cold).sum("tree_builder", "lines_invalidated"), 0U);
  EXPECT_GT(outcome_of(warm).sum("tree_builder", "lines_invalidated"), 100U);
}

std::string complaint(std::vector<std::string> sets) {
  try {
    load_run_config(options_of("car", std::move(sets)));
  } catch (const sim::InputError& error) {
    return error.what();
  }
  return "none";
}

TEST(BuiltFrames, RefuseWhatNoEngineBuilds) {
  const auto names = [](const std::string& text, const char* part) { return text.find(part) != std::string::npos; };
  EXPECT_EQ(complaint({"build.engine=srp"}), "none");
  EXPECT_EQ(complaint({"build.engine=srp", "build.policy=refit", "bvh.instances=two_level"}), "none");
  EXPECT_EQ(complaint({"build.engine=srp", "bvh.width=4"}), "none");
  EXPECT_TRUE(names(complaint({"build.engine=srp", "bvh.boxes=single"}), "build.engine"));
  EXPECT_TRUE(names(complaint({"build.engine=srp", "bvh.morton_bits=63"}), "build.engine"));
  EXPECT_TRUE(names(complaint({"build.engine=srp", "build.overlap=on"}), "overlap"));
  EXPECT_TRUE(names(complaint({"build.engine=unit", "bvh.builder=ploc"}), "tree_builder.comparators"));
  EXPECT_EQ(complaint({"build.engine=unit", "bvh.builder=ploc", "tree_builder.comparators=16"}), "none");
}

TEST(BuiltFrames, RefuseRecordsWithoutRoomForLongKeys) {
  const auto with = [](const char* bits, const char* bytes) {
    return complaint({"build.engine=unit", "bvh.builder=lbvh", fmt::format("bvh.morton_bits={}", bits),
                      fmt::format("tree_builder.record_bytes={}", bytes)});
  };
  for (const char* bytes : {"8", "32"}) {
    const std::string text = with("63", bytes);
    EXPECT_TRUE(text.find("tree_builder.record_bytes") != std::string::npos && text.find("12") != std::string::npos)
        << text;
    EXPECT_EQ(with("30", bytes), "none");
  }
  for (const char* bytes : {"12", "36"}) EXPECT_EQ(with("63", bytes), "none");
  EXPECT_EQ(complaint({"bvh.builder=lbvh", "bvh.morton_bits=63"}), "none") << "the host has no records";
}

TEST(BuiltFrames, WarnIfTheEngineCannotBuildTheTree) {
  const auto warns = [](const std::vector<std::string>& sets) {
    return std::ranges::any_of(load_inputs(options_of("car", sets, "0")).warnings,
                               [](const std::string& line) { return line.find("bvh.builder=lbvh") != line.npos; });
  };
  EXPECT_TRUE(warns({"build.engine=unit"}));
  EXPECT_FALSE(warns({"build.engine=unit", "bvh.builder=lbvh"}));
  EXPECT_FALSE(warns({}));
}

TEST(BuiltFrames, ReportTheCostOfTheirTrees) {
  JobOptions options = options_of("car", {"build.engine=unit", "build.policy=period", "build.period=2"});
  Inputs inputs = load_inputs(options);
  std::vector<MovedTree> trees;
  for_each_frame(inputs, 1, nullptr,
                 [&] { trees.push_back(*simulate_frame(inputs, kernels::parse_program(options.program), 1).tree); });
  ASSERT_EQ(trees.size(), 4U);
  for (std::size_t i = 0; i < trees.size(); ++i) {
    EXPECT_EQ(trees[i].refitted, i % 2 == 1);
    EXPECT_GT(trees[i].sah_cost, 0);
    const double built = trees[i - i % 2].sah_cost;
    EXPECT_DOUBLE_EQ(trees[i].sah_growth, trees[i].sah_cost / built);
  }
}

}  // namespace
}  // namespace tools
