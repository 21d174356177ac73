#include "tools/run/representative_frames.h"

#include <cstdint>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "sim/error.h"
#include "tests/tools/program.h"
#include "tools/sampling/frame_counts.h"

namespace tools {
namespace {

JobOptions orbit_options(const char* degrees, const char* frames) {
  JobOptions options;
  options.scene = "teapot";
  options.resolution = "64x32";
  options.frames = frames;
  options.threads = 1;
  options.sets = {"scene.camera_path=orbit", "scene.frame_rate=1", std::string("scene.orbit=") + degrees,
                  "scene.triangles=2000"};
  return options;
}

sim::Json report_of(JobOptions options, const char* representative) {
  options.representative = representative;
  return plain_report(load_inputs(options), options);
}

TEST(RepresentativeFrames, OfTwoCameraPositionsAreTwoClustersWithExactTotals) {
  const JobOptions options = orbit_options("180", "0:8");
  const sim::Json whole = report_of(options, ""), some = report_of(options, "auto");
  const sim::Json& totals = some["totals"];
  EXPECT_EQ(some["sequence"]["cluster_of_frame"], sim::Json(std::vector<std::uint32_t>{0, 1, 0, 1, 0, 1, 0, 1, 0}));
  EXPECT_EQ(totals["representative"]["simulated"], 4);
  EXPECT_EQ(totals["representative"]["frames"], 9);
  for (const char* metric : {"cycles", "rays", "traversal_steps", "dram_bytes"})
    EXPECT_EQ(totals[metric], whole["totals"][metric]);
  const double energy = whole["totals"]["energy_mj"]["nominal"].get<double>();
  EXPECT_NEAR(totals["energy_mj"]["nominal"].get<double>(), energy, 1e-9 * energy);
  EXPECT_NEAR(totals["perf"]["fps"].get<double>(), whole["totals"]["perf"]["fps"].get<double>(), 1e-6);
  double weights = 0;
  for (const sim::Json& frame : some["frames"]) {
    EXPECT_EQ(frame["cluster"].get<int>(), frame["frame"].get<int>() % 2);
    EXPECT_NEAR(frame["weight"].get<double>(), frame["cluster"] == 0 ? 2.5 : 2, 1e-9);
    weights += frame["weight"].get<double>();
  }
  EXPECT_NEAR(weights, 9, 1e-9);
  EXPECT_EQ(some["units"], whole["units"]);
}

TEST(RepresentativeFrames, DoNotDependOnThreadsAndDependOnTheDraw) {
  JobOptions options = orbit_options("7", "0:19");
  sim::Json one = report_of(options, "3");
  const sim::Json other = report_of(options, "3:2");
  options.threads = 3;
  sim::Json three = report_of(options, "3");
  for (sim::Json* report : {&one, &three}) {
    report->erase("host");
    report->erase("provenance");
  }
  EXPECT_EQ(one, three);
  EXPECT_NE(one["frames"], other["frames"]);
  EXPECT_EQ(one["totals"]["representative"]["simulated"], 6);
}

TEST(RepresentativeFrames, OfAShortSequenceWithVaryingFramesAreAllOfThem) {
  const JobOptions options = orbit_options("50", "2:5");
  const sim::Json whole = report_of(options, ""), some = report_of(options, "auto");
  EXPECT_EQ(some["totals"]["representative"]["simulated"], 4);
  EXPECT_EQ(some["totals"]["cycles"], whole["totals"]["cycles"]);
  EXPECT_EQ(some["totals"]["representative"]["cycles"]["low"], some["totals"]["representative"]["cycles"]["high"]);
}

TEST(RepresentativeFrames, MayHavePaths) {
  JobOptions options = orbit_options("180", "0:7");
  options.program = "path:1";
  options.sets.emplace_back("render.depth=2");
  const sim::Json whole = report_of(options, ""), some = report_of(options, "2");
  EXPECT_EQ(some["totals"]["representative"]["simulated"], 4);
  const double cycles = whole["totals"]["cycles"].get<double>();
  EXPECT_NEAR(some["totals"]["cycles"].get<double>(), cycles, 0.05 * cycles) << "paths differ from frame to frame";
}

TEST(RepresentativeFrames, BuildTheFirstTreeAndRefitItInLaterFrames) {
  JobOptions options;
  options.scene = "car";
  options.resolution = "32x16";
  options.frames = "0:4";
  options.threads = 1;
  options.sets = {"scene.triangles=3000", "render.tile=16", "build.engine=unit", "build.policy=refit",
                  "bvh.builder=lbvh"};
  const sim::Json whole = report_of(options, ""), some = report_of(options, "auto");
  ASSERT_EQ(some["totals"]["representative"]["simulated"], 5) << "too few frames to leave some out";
  EXPECT_EQ(some["totals"]["cycles"], whole["totals"]["cycles"]);
  for (const sim::Json& frame : some["frames"]) EXPECT_EQ(frame["tree"]["refitted"], frame["frame"] != 0);
  Inputs inputs = load_inputs(options);
  const auto triangles = static_cast<double>(inputs.image.triangles.size());
  const std::vector<FrameCounts> counts = count_frames(inputs, kernels::parse_program("full:1"), 1, nullptr);
  for (std::size_t i = 0; i < counts.size(); ++i) {
    EXPECT_EQ(counts[i].built, i == 0 ? triangles : 0);
    EXPECT_EQ(counts[i].refitted, i == 0 ? 0 : triangles);
  }
}

TEST(RepresentativeFrames, CountNoTreesThatTheHostBuilds) {
  JobOptions options;
  options.scene = "car";
  options.resolution = "16x8";
  options.frames = "0:15";
  options.sets = {"scene.triangles=1000", "render.tile=8", "bvh.builder=lbvh"};
  Inputs inputs = load_inputs(options);
  for (const FrameCounts& frame : count_frames(inputs, kernels::parse_program("full:1"), 1, nullptr)) {
    EXPECT_EQ(frame.built, 0);
    EXPECT_EQ(frame.refitted, 0);
  }
}

TEST(RepresentativeFrames, MayHaveSampledTiles) {
  JobOptions options = orbit_options("180", "0:5");
  options.resolution = "160x160";
  options.sets.insert(options.sets.end(), {"render.tile=4", "cores=2"});
  options.tile_sampling = "5%";
  options.image = "none";
  const sim::Json some = report_of(options, "2");
  const sim::Json& interval = some["totals"]["representative"]["cycles"];
  EXPECT_LT(interval["low"].get<double>(), interval["estimate"].get<double>());
  EXPECT_TRUE(some["frames"][0].contains("sampled"));
  EXPECT_FALSE(some["totals"].contains("sampled"));
}

TEST(FrameCounts, AreThoseOfFramesAndDoNotDependOnThreadsOrOrder) {
  const JobOptions options = orbit_options("180", "0:3");
  Inputs inputs = load_inputs(options);
  const std::vector<FrameCounts> one = count_frames(inputs, kernels::parse_program("full:1"), 1, nullptr);
  go_to_frame(inputs, 0, 1);
  EXPECT_EQ(count_frames(inputs, kernels::parse_program("full:1"), 3, nullptr), one);
  EXPECT_EQ(one.size(), 4U);
  EXPECT_EQ(one[0], one[2]);
  EXPECT_NE(one[0], one[1]);
  EXPECT_EQ(one[0].primary, 64 * 32) << "a picture this small is counted whole";
  EXPECT_GT(one[0].visits, one[0].primary);
  EXPECT_GE(one[0].tile_lines, one[0].tree_lines + one[0].data_lines);
  go_to_frame(inputs, 0, 1);
  const FrameResult frame = simulate_frame(inputs, kernels::parse_program("full:1"), 1);
  EXPECT_EQ(one[0].visits + one[0].tests, static_cast<double>(frame.rendered.traversal_steps));
}

TEST(RepresentativeFrames, RefuseWhatCannotBeCombined) {
  EXPECT_EQ(parse_representative("auto").clusters, 0U);
  EXPECT_EQ(parse_representative("12:5").clusters, 12U);
  EXPECT_EQ(parse_representative("12:5").draw, 5U);
  for (const char* bad : {"", "0", "-1", "x", "12:", "auto:x", "5%", "1001"})
    EXPECT_THROW(parse_representative(bad), sim::InputError) << bad;
  const auto refused = [](const char* more) {
    JobOptions options = orbit_options("7", "0:9");
    options.sets.emplace_back(more);
    EXPECT_THROW(report_of(options, "auto"), sim::InputError) << more;
  };
  refused("render.primary=raster");
  refused("thermal.minutes=1");
  refused("build.policy=cost");
  EXPECT_THROW(report_of(orbit_options("7", "3"), "auto"), sim::InputError);
}

}  // namespace
}  // namespace tools

namespace test {
namespace {

TEST(RepresentativeRun, ShowsWhichFramesWereSimulated) {
  const TempFolder folder;
  const ProcessResult ending = raywatt(small_run(
      folder.path() / "out", {"--scene", "teapot", "--set", "scene.camera_path=orbit", "--set", "scene.orbit=180",
                              "--set", "scene.frame_rate=1", "--frames", "0:7", "--representative", "auto"}));
  ASSERT_EQ(ending.exit, 0) << ending.err;
  EXPECT_SAYS(ending.out, "4 of 8 frames simulated, of 2 clusters");
}

TEST(RepresentativeRun, RefusesOptionsOfOtherRuns) {
  for (const Words& other : std::vector<Words>{{"--slices", "2"},
                                               {"--replicates", "3"},
                                               {"--reference", "full:1"},
                                               {"--timeline", "all"},
                                               {"--record", "x.trace"},
                                               {"--debug-images"}}) {
    Words more = {"--representative", "auto", "--frames", "0:7"};
    more.insert(more.end(), other.begin(), other.end());
    expect_refused_run(more, {"--representative", other.front()});
  }
  expect_refused_run({"--representative", "auto", "--frames", "0:7", "--program", "undersample"}, {"full:N"});
  expect_refused_run({"--representative", "many", "--frames", "0:7"}, {"allowed: auto"});
  expect_refused_run({"--representative", "auto"}, {"allowed: several frames"});
}

}  // namespace
}  // namespace test
