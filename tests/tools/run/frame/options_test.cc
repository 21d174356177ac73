#include <gtest/gtest.h>

#include "sim/error.h"
#include "tools/run/frame/job_options.h"
#include "tools/run/frame/run_job.h"

namespace test {
namespace {

using tools::parse_resolution;

TEST(Resolution, IsTwoNumbersWithACross) {
  const tools::Resolution r = parse_resolution("1024x512");
  EXPECT_EQ(r.width, 1024U);
  EXPECT_EQ(r.height, 512U);
  EXPECT_EQ(parse_resolution("1x16384").height, 16384U);
}

TEST(Resolution, IsRefusedOtherwise) {
  for (const char* text : {"", "x", "1024", "1024x", "x512", "1024X512", "1024 x 512", "+1x1", "-1x1", "0x1", "1x0",
                           "16385x1", "1x16385", "1x1x1", "1x1 ", " 1x1", "1.5x1", "4294967297x1"}) {
    EXPECT_THROW(parse_resolution(text), sim::InputError) << '\'' << text << '\'';
  }
}

TEST(Resolution, OverridesTheConfigurationAndItsSets) {
  tools::JobOptions options;
  options.sets = {"render.width=8"};
  options.resolution = "48x24";
  const tools::RunConfig config = tools::load_run_config(options);
  EXPECT_EQ(config.render.width, 48U);
  EXPECT_EQ(config.render.height, 24U);
}

TEST(MobileWorkload, M3IsTheInputOfAnUpscalerToTheSizeOfM4) {
  tools::JobOptions options;
  options.scene = "mobile-m3";
  const tools::RunConfig small = tools::load_run_config(options);
  options.scene = "mobile-m4";
  const tools::RunConfig full = tools::load_run_config(options);
  EXPECT_EQ(small.programs.denoise.external_upscaling * small.render.width, full.render.width);
  EXPECT_EQ(small.programs.denoise.external_upscaling * small.render.height, full.render.height);
  EXPECT_EQ(full.programs.denoise.external_upscaling, 1);
}

TEST(Threads, AreAllOfTheHostUnlessGiven) {
  EXPECT_EQ(tools::host_threads(3), 3U);
  EXPECT_GE(tools::host_threads(0), 1U);
}

}  // namespace
}  // namespace test
