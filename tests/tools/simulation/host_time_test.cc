#include "tools/simulation/host_time.h"

#include <gtest/gtest.h>

#include "tests/temp_folder.h"
#include "tests/traces/scene/tiny_gltf_file.h"
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

TEST(HostTime, OfAPictureIsTheStepsOfASmallOneTimesATenthOfAMicrosecond) {
  const kernels::ProgramSpec full = kernels::parse_program("full:1");
  const std::uint64_t steps = simulate(inputs_of("24x12"), full, 1).function.traversal_steps;
  ASSERT_GT(steps, 0U);
  EXPECT_DOUBLE_EQ(estimated_host_seconds(inputs_of("72x36"), full), 9 * static_cast<double>(steps) * 100e-9);
}

TEST(HostTime, GrowsWithPixelsAndSamples) {
  const kernels::ProgramSpec one = kernels::parse_program("full:1"), four = kernels::parse_program("full:4");
  const Inputs small = inputs_of("72x36"), large = inputs_of("7200x3600");
  const double seconds = estimated_host_seconds(small, one);
  EXPECT_DOUBLE_EQ(estimated_host_seconds(large, one), 10'000 * seconds) << "the same pixels are looked at";
  EXPECT_DOUBLE_EQ(estimated_host_seconds(small, four), 4 * seconds);
}

TEST(HostTime, CountsInstancesThatRaysEnterInOnePlaceAfterAnother) {
  const test::TempFolder folder;
  test::TinyGltf file;
  for (int node = 1; node < 100; ++node) {
    file.json["nodes"].push_back({{"mesh", 0}});
    file.json["scenes"][0]["nodes"].push_back(node);
  }
  JobOptions options;
  options.scene = folder.write("stack.gltf", file.text()).string();
  options.resolution = "72x36";
  options.sets = {"bvh.instances=two_level"};
  const Inputs inputs = load_inputs(options);
  const kernels::ProgramSpec full = kernels::parse_program("full:1");
  options.resolution = "24x12";
  const std::uint64_t steps = simulate(load_inputs(options), full, 1).function.traversal_steps;
  EXPECT_GT(estimated_host_seconds(inputs, full), 2 * 9 * static_cast<double>(steps) * 100e-9);
}

}  // namespace
}  // namespace tools
