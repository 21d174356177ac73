#include <string>

#include <gtest/gtest.h>

#include "sim/error.h"
#include "tests/hw_models/machines/gpu_harness.h"
#include "tools/run/frame/machine_run.h"
#include "traces/trace_file/tree_links.h"

// Tests of replicates, which simulate one recording several times.

namespace tools {
namespace {

const Inputs& small_inputs() {
  static const Inputs in = [] {
    JobOptions options;
    options.resolution = "64x32";
    options.sets = {"render.tile=16"};
    return load_inputs(options);
  }();
  return in;
}

FrameResult run(std::uint32_t replicates, std::uint32_t threads, const char* program = "full:1") {
  return simulate_frame(small_inputs(), kernels::parse_program(program), threads, {.replicates = replicates});
}

hw::test::Outcome outcome_of(const FrameResult& s) { return {s.units, s.kernel_use, {}, s.elapsed, s.cycles}; }

TEST(Replicates, LeaveThePlainRunAsItIsToTheLastCounter) {
  const FrameResult plain = run(1, 1), first = run(4, 1);
  EXPECT_TRUE(plain.replicates.empty());
  EXPECT_EQ(first.replicates.size(), 3U);
  EXPECT_EQ(difference(outcome_of(plain), outcome_of(first)), "");
  EXPECT_EQ(hw::test::difference(plain.rendered, first.rendered), "");
  EXPECT_EQ(plain.energy.total_pj.nominal, first.energy.total_pj.nominal);
}

TEST(Replicates, AreTheSameForAnyNumberOfThreadsAndOfReplicates) {
  const FrameResult alone = run(5, 1);
  for (const std::uint32_t threads : {2U, 5U}) {
    const FrameResult other = run(5, threads);
    for (std::size_t i = 0; i < 4; ++i) {
      EXPECT_EQ(difference(outcome_of(alone.replicates[i]), outcome_of(other.replicates[i])), "") << threads << i;
    }
  }
  EXPECT_EQ(difference(outcome_of(alone.replicates[0]), outcome_of(run(2, 1).replicates[0])), "");
}

TEST(Replicates, DifferFromThePlainRunAndFromEachOther) {
  const FrameResult s = run(4, 1);
  EXPECT_NE(difference(outcome_of(s), outcome_of(s.replicates[0])), "");
  EXPECT_NE(difference(outcome_of(s.replicates[0]), outcome_of(s.replicates[1])), "");
  EXPECT_NE(difference(outcome_of(s.replicates[1]), outcome_of(s.replicates[2])), "");
}

TEST(Replicates, TraceNoRaysAgain) {
  const FrameResult s = run(3, 1, "multirate:under");
  for (const FrameResult& replicate : s.replicates) {
    EXPECT_EQ(replicate.rays(), s.rays());
    EXPECT_EQ(replicate.rendered.traversal_steps, s.rendered.traversal_steps);
    EXPECT_TRUE(replicate.rendered.rgb.empty());
  }
}

TEST(InMemoryTrace, IsTheWorkThatWasRecordedToTheLastCounter) {
  const hw::test::Frame frame("teapot", 64, 32);
  const traces::MemoryImage& image = frame.workload().image;
  InMemoryTrace kept({traces::links_of(image), traces::counts_of(image), 1000, frame.workload().needs.region_bytes},
                     1U << 30, "--replicates");
  for (const traces::TileWork& work : frame.record()) kept.add(work);
  EXPECT_EQ(kept.tiles(), frame.program().tiles());
  std::uint32_t finished = 0;
  InMemoryTraceProgram program(kept, frame.workload().needs, [&] { finished += 1; });
  const NoTracer no_tracer;
  FrontEnd tiles(program, no_tracer, 0);
  const hw::GpuConfig config;
  EXPECT_EQ(difference(hw::test::play(frame, tiles, config, {}), hw::test::play(frame, config)), "");
  EXPECT_EQ(finished, kept.tiles());
}

TEST(InMemoryTrace, BeyondItsMemoryIsRefusedByName) {
  const hw::test::Frame& frame = hw::test::cornell_64x32();
  const traces::MemoryImage& image = frame.workload().image;
  InMemoryTrace kept({traces::links_of(image), traces::counts_of(image), 1000, frame.workload().needs.region_bytes},
                     100, "dvfs");
  try {
    kept.add(frame.record().front());
    FAIL() << "100 bytes hold no tile";
  } catch (const sim::InputError& error) {
    EXPECT_NE(std::string(error.what()).find("limits.memory"), std::string::npos) << error.what();
    EXPECT_TRUE(std::string(error.what()).starts_with("dvfs: ")) << error.what();
  }
}

}  // namespace
}  // namespace tools
