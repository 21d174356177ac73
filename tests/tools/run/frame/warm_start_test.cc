#include <cmath>
#include <string>

#include <gtest/gtest.h>

#include "tests/hw_models/machines/gpu_harness.h"
#include "tests/temp_folder.h"
#include "tools/run/frame/machine_run.h"
#include "tools/run/frame/trace_header.h"
#include "tools/run/run.h"
#include "tools/run/stored_frames.h"
#include "tools/sampling/slices.h"
#include "tools/sampling/tile_sampling.h"
#include "traces/trace_file/trace_writer.h"

// Tests of frames that begin with the caches as the previous frame left them.

namespace tools {
namespace {

JobOptions options_of(const std::string& scene, const std::string& program = "full:1") {
  JobOptions options;
  options.scene = scene;
  options.program = program;
  options.resolution = "128x64";
  // The default L2 holds much of the scene. A small one is full of the last tiles' lines, which the first tiles do not
  // read.
  options.sets = {"frame.start=warm", "render.tile=16", "l2.size=1 MiB"};
  options.threads = 1;
  return options;
}

hw::test::Outcome machine_outcome(const FrameResult& s) { return {s.units, s.kernel_use, {}, s.elapsed, s.cycles}; }

/// Returns the lines that the L2 fetches from memory. Cycles of such a small frame are mostly noise.
std::uint64_t fills_of(const FrameResult& s) { return machine_outcome(s).sum("bank", "fills"); }

/// Returns the number of L2 fills of each frame of a run.
std::vector<double> fills_of_frames(JobOptions options, const std::string& frames) {
  options.frames = frames;
  Inputs inputs = load_inputs(options);
  RenderedFrames source(inputs, make_plan(options), options.threads, nullptr);
  std::vector<double> fills;
  run(source, {.on_frame = [&](const SimulatedFrame& played) {
        fills.push_back(static_cast<double>(fills_of(played.frame)));
      }});
  return fills;
}

FrameResult first_frame(const JobOptions& options, std::uint32_t threads = 1, const SimulateOptions& extras = {}) {
  return simulate_frame(load_inputs(options), kernels::parse_program(options.program), threads, extras);
}

TEST(WarmStart, OfASingleFrameIsLikeThatOfTheSecondOfTwoEqualFrames) {
  for (const char* scene : {"cornell", "teapot"}) {
    const std::vector<double> warm = fills_of_frames(options_of(scene), "0:2");
    JobOptions cold = options_of(scene);
    cold.sets.front() = "frame.start=cold";
    const std::vector<double> empty = fills_of_frames(cold, "0:1");
    EXPECT_EQ(empty[0], empty[1]) << scene;
    EXPECT_LT(warm[1], 0.9 * empty[0]) << scene;
    EXPECT_NEAR(warm[0], warm[1], 0.05 * empty[0]) << scene;
    EXPECT_NEAR(warm[2], warm[1], 0.05 * empty[0]) << scene;
  }
}

TEST(WarmStart, OfASceneThatFitsLeavesNothingToFetch) {
  JobOptions options = options_of("teapot");
  options.sets.emplace_back("l2.size=4 MiB");
  const std::vector<double> fills = fills_of_frames(options, "0:1");
  EXPECT_EQ(fills[0], 0);
  EXPECT_EQ(fills[1], 0);
}

TEST(WarmStart, ReachesTheSystemCache) {
  JobOptions options = options_of("teapot");
  options.sets.emplace_back("slc.size=4 MiB");
  const auto missed = [&] { return machine_outcome(first_frame(options)).sum("slice", "misses"); };
  const std::uint64_t warm = missed();
  options.sets.front() = "frame.start=cold";
  EXPECT_LT(2 * warm, missed());
}

TEST(WarmStart, DoesNotDependOnThreads) {
  for (const char* program : {"full:1", "undersample"}) {
    const JobOptions options = options_of("cornell", program);
    EXPECT_EQ(difference(machine_outcome(first_frame(options)), machine_outcome(first_frame(options, 3))), "")
        << program;
  }
}

TEST(WarmStart, LeavesThePictureAsItIs) {
  for (const char* program : {"full:1", "undersample", "supersample", "multirate:under", "reconstruct"}) {
    JobOptions options = options_of("cornell", program);
    const FrameResult warm = first_frame(options);
    options.sets.front() = "frame.start=cold";
    const FrameResult cold = first_frame(options);
    EXPECT_EQ(hw::test::difference(warm.rendered, cold.rendered), "") << program;
    EXPECT_LT(fills_of(warm), fills_of(cold)) << program;
  }
}

TEST(WarmStart, OfAFrameWithAGeometryPassPlaysAllPasses) {
  JobOptions options = options_of("cornell");
  options.sets.emplace_back("render.primary=raster");
  const FrameResult warm = first_frame(options);
  options.sets.front() = "frame.start=cold";
  EXPECT_LT(fills_of(warm), fills_of(first_frame(options)));
}

TEST(WarmStart, OfAReplayIsThatOfTheRun) {
  const test::TempFolder folder;
  JobOptions options = options_of("cornell");
  options.frames = "0:1";
  Inputs inputs = load_inputs(options);
  traces::TraceWriter writer(folder.path() / "a.trace", trace_header(inputs, options));
  RenderedFrames frames(inputs, make_plan(options), 1, nullptr);
  const RunResult ran = run(frames, {.trace = &writer});
  writer.commit();
  JobOptions replay;
  replay.config.clear();
  replay.threads = 1;
  StoredFrames stored(folder.path() / "a.trace", replay);
  const RunResult replayed = run(stored, {});
  EXPECT_EQ(difference(machine_outcome(*ran.total), machine_outcome(*replayed.total)), "");
  stored.go_to_first_frame();
  EXPECT_EQ(difference(machine_outcome(*ran.total), machine_outcome(*run(stored, {}).total)), "");
}

TEST(WarmStart, OfReplicatesIsThatOfThePlainRun) {
  const JobOptions options = options_of("cornell");
  const FrameResult plain = first_frame(options), three = first_frame(options, 2, {.replicates = 3});
  EXPECT_EQ(difference(machine_outcome(plain), machine_outcome(three)), "");
  JobOptions cold = options;
  cold.sets.front() = "frame.start=cold";
  const FrameResult empty = first_frame(cold, 1, {.replicates = 3});
  for (std::size_t i = 0; i < 2; ++i) EXPECT_LT(fills_of(three.replicates[i]), fills_of(empty.replicates[i]));
}

TEST(WarmStart, OfRecordedWorkIsThatOfTheRun) {
  const JobOptions options = options_of("teapot");
  const Inputs inputs = load_inputs(options);
  const RecordedFrame recorded(inputs, {}, "test", 1);
  const std::vector<FrameResult> played = recorded.simulate(std::vector<RunConfig>(2, inputs.config));
  for (const FrameResult& s : played) {
    EXPECT_EQ(difference(machine_outcome(first_frame(options)), machine_outcome(s)), "");
  }
}

TEST(WarmStart, OfAFrameTooSmallToSampleIsThatOfTheWholeFrame) {
  const JobOptions options = options_of("cornell");
  const Inputs inputs = load_inputs(options);
  const FrameResult sampled = simulate_sampled(inputs, {}, 1, {});
  EXPECT_EQ(sampled.cycles, first_frame(options).cycles);
}

TEST(WarmStart, OfSlicesIsWithinTheirInterval) {
  JobOptions options = options_of("teapot");
  options.resolution = "256x128";
  const Inputs inputs = load_inputs(options);
  const FrameResult whole = first_frame(options), sliced = simulate_slices(inputs, {}, 1, 2, nullptr);
  EXPECT_NEAR(static_cast<double>(sliced.cycles), static_cast<double>(whole.cycles),
              sliced.sliced->cycles.half_width() + 0.01 * static_cast<double>(whole.cycles));
}

}  // namespace
}  // namespace tools
