#include "tools/simulation/host_time.h"

#include <gtest/gtest.h>

#include "tools/simulation/run_job.h"

// How long a run may take, said before it begins.

namespace tools {
namespace {

Inputs inputs_of(const std::string& resolution) {
  JobOptions options;
  options.scene = "cornell";
  options.resolution = resolution;
  return load_inputs(options);
}

TEST(HostTime, OfAPictureThatIsLookedAtWholeIsItsStepsTimesATenthOfAMicrosecond) {
  const Inputs inputs = inputs_of("24x12");
  const kernels::ProgramSpec full = kernels::parse_program("full:1");
  const std::uint64_t steps = simulate(inputs, full, 1).function.traversal_steps;
  ASSERT_GT(steps, 0U);
  EXPECT_DOUBLE_EQ(estimated_host_seconds(inputs, full), static_cast<double>(steps) * 100e-9);
}

TEST(HostTime, GrowsWithPixelsAndSamples) {
  const kernels::ProgramSpec one = kernels::parse_program("full:1"), four = kernels::parse_program("full:4");
  const Inputs small = inputs_of("24x12"), large = inputs_of("2400x1200");
  const double seconds = estimated_host_seconds(small, one);
  EXPECT_DOUBLE_EQ(estimated_host_seconds(large, one), 10'000 * seconds) << "the same pixels are looked at";
  EXPECT_DOUBLE_EQ(estimated_host_seconds(small, four), 4 * seconds);
}

}  // namespace
}  // namespace tools
