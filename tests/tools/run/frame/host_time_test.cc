#include "tools/run/frame/host_time.h"

#include <gtest/gtest.h>

#include "tools/run/frame/run_job.h"

// Tests of estimating the host time of a run: traversal steps, and a measured rate.

namespace tools {
namespace {

Inputs inputs_of(const std::string& resolution) {
  JobOptions options;
  options.scene = "cornell";
  options.resolution = resolution;
  return load_inputs(options);
}

const kernels::ProgramSpec kOne = kernels::parse_program("full:1"), kFour = kernels::parse_program("full:4");

TEST(HostTime, StepsOfAPictureAreThoseOfASmallOneScaledByItsPixels) {
  const std::uint64_t steps = simulate_frame(inputs_of("24x12"), kOne, 1).rendered.traversal_steps;
  ASSERT_GT(steps, 0U);
  EXPECT_DOUBLE_EQ(estimate_steps(inputs_of("72x36"), kOne), 9 * static_cast<double>(steps));
}

TEST(HostTime, StepsGrowWithPixelsAndSamples) {
  const Inputs small = inputs_of("72x36"), large = inputs_of("7200x3600");
  const double steps = estimate_steps(small, kOne);
  EXPECT_DOUBLE_EQ(estimate_steps(large, kOne), 10'000 * steps) << "the same pixels are looked at";
  EXPECT_DOUBLE_EQ(estimate_steps(small, kFour), 4 * steps);
}

TEST(HostTime, OfAFrameOnOneThreadIsBothHalvesAndOnSeveralTheLongerOne) {
  const HostRate rate{.functional = 1, .machine = 8};
  EXPECT_DOUBLE_EQ(host_seconds_of_frame(10, rate, {.threads = 1}), 90);
  EXPECT_DOUBLE_EQ(host_seconds_of_frame(10, rate, {.threads = 4}), 80) << "the machine is played by one thread";
  EXPECT_DOUBLE_EQ(host_seconds_of_frame(10, {.functional = 12, .machine = 3}, {.threads = 4}), 40);
}

TEST(HostTime, OfReplicatesIsThatOfOneMorePlayForAsManyAsThereAreThreads) {
  const HostRate rate{.functional = 0, .machine = 1};
  EXPECT_DOUBLE_EQ(host_seconds_of_frame(10, rate, {.threads = 2, .replicates = 5}), 30)
      << "two rounds of two after the first";
  EXPECT_DOUBLE_EQ(host_seconds_of_frame(10, rate, {.threads = 1, .replicates = 5}), 50);
}

TEST(HostTime, OfSlicesIsSharedByTheThreads) {
  const HostRate rate{.functional = 0, .machine = 1};
  EXPECT_DOUBLE_EQ(host_seconds_of_frame(12, rate, {.threads = 4, .slices = 3}), 4);
  EXPECT_DOUBLE_EQ(host_seconds_of_frame(12, rate, {.threads = 2, .slices = 3}), 6);
}

TEST(HostTime, IsMeasuredFromAMinuteOfTheSlowestStepsOn) {
  EXPECT_FALSE(may_take_minutes(14.9e6, {}));  // 4 us each
  EXPECT_TRUE(may_take_minutes(15.1e6, {}));
  EXPECT_TRUE(may_take_minutes(4e6, {.replicates = 4}));
}

TEST(HostTime, OfAShortFrameIsNotMeasured) {
  const Inputs inputs = inputs_of("24x12");
  EXPECT_DOUBLE_EQ(estimate_seconds(inputs, kOne, {.threads = 1}),
                   host_seconds_of_frame(estimate_steps(inputs, kOne), kUsualRate, {.threads = 1}));
}

TEST(HostTime, IsMeasuredOnTilesOfTheMachineThatIsNamed) {
  for (const kernels::ProgramSpec& spec : {kOne, kFour, kernels::parse_program("undersample")}) {
    const HostRate rate = measure_rate(inputs_of("64x32"), spec);
    EXPECT_GT(rate.functional, 0) << spec.name();
    EXPECT_GT(rate.machine, rate.functional) << spec.name();
  }
}

}  // namespace
}  // namespace tools
