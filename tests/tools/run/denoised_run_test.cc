#include <filesystem>
#include <string>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/tools/program.h"

// Tests of runs whose frames are denoised.

namespace test {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

const Words kNoisy = {"--scene", "cornell",
                      "--set",   "render.effects=soft_shadows",
                      "--set",   "render.shadow_rays=1",
                      "--set",   "render.light_radius=0.05"};
const Words kAtrous = {"--set", "denoise.filter=atrous"};

Words joined(std::initializer_list<Words> parts) {
  Words all;
  for (const Words& part : parts) all.insert(all.end(), part.begin(), part.end());
  return all;
}

class DenoisedRun : public ::testing::Test {
 protected:
  Json run(const std::string& out, const Words& more, const std::string& threads = "1") const {
    const ProcessResult ending = raywatt(joined(
        {{"run", "--resolution", "64x32", "--threads", threads, "-o", (folder_.path() / out).string()}, kNoisy, more}));
    EXPECT_EQ(ending.exit, 0) << ending.err;
    return read_json(folder_.path() / out / "report.json");
  }
  TempFolder folder_;
};

TEST_F(DenoisedRun, FramesHandTheirHistoryOnAndAReplayHasTheSameReport) {
  const std::string trace = (folder_.path() / "a.trace").string();
  const Json report = run("a", joined({kAtrous, {"--frames", "2:5", "--reference", "full:16", "--record", trace}}));
  const Json &totals = report["totals"], &frames = report["frames"];
  EXPECT_GT(frames[3]["psnr_db"].get<double>(), frames[0]["psnr_db"].get<double>() + 0.5) << "history removes noise";
  EXPECT_LT(frames[3]["flip"].get<double>(), frames[0]["flip"].get<double>());
  EXPECT_FALSE(frames[0].contains("flicker"));
  EXPECT_GT(totals["flicker"].get<double>(), 0);
  for (const char* share : {"time_share", "dram_share", "energy_share"}) {
    EXPECT_GT(totals["denoise"][share].get<double>(), 0) << share;
    EXPECT_LT(totals["denoise"][share].get<double>(), 1) << share;
  }
  EXPECT_FALSE(read_json(folder_.path() / "a" / "reference.json")["totals"].contains("denoise"));
  ASSERT_EQ(raywatt({"trace", "replay", trace, "-o", (folder_.path() / "b").string(), "--threads", "1"}).exit, 0);
  EXPECT_EQ(read_json(folder_.path() / "b" / "report.json")["totals"], totals);
}

TEST_F(DenoisedRun, AnExternalUnitAddsItsCostsAndNothingElse) {
  Json plain = run("plain", {})["totals"];
  Json external = run("external", {"--set", "denoise.filter=external", "--set", "denoise.external_time=10"})["totals"];
  const Json denoise = external["denoise"];
  external.erase("denoise");
  EXPECT_EQ(plain, external);
  constexpr double kPixels = 64 * 32;
  EXPECT_NEAR(denoise["time_ms"].get<double>(), kPixels * 10e-6, 1e-9);
  EXPECT_NEAR(denoise["dram_bytes"].get<double>(), kPixels * 13.6, 1);
  EXPECT_NEAR(denoise["energy_mj"].get<double>(), kPixels * 2950e-9, 1e-9);
  EXPECT_NEAR(denoise["time_share"].get<double>(), kPixels * 10e-6 / (kPixels * 10e-6 + plain["time_ms"].get<double>()),
              1e-9);
}

TEST_F(DenoisedRun, AnExternalUnitCostsItsOutputPixels) {
  const Words unit = {"--set", "denoise.filter=external"};
  const Json same = run("same", unit)["totals"]["denoise"];
  const Json upscaled = run("upscaled", joined({unit, {"--set", "denoise.external_upscaling=2"}}))["totals"]["denoise"];
  for (const char* cost : {"time_ms", "dram_bytes", "energy_mj"}) {
    EXPECT_NEAR(upscaled[cost].get<double>() / same[cost].get<double>(), 4, 1e-3) << cost;
  }
}

TEST_F(DenoisedRun, ThreadsChangeNothing) {
  const Json one = run("one", joined({kAtrous, {"--frames", "0:1"}}));
  const Json three = run("three", joined({kAtrous, {"--frames", "0:1"}}), "3");
  EXPECT_EQ(one["totals"], three["totals"]);
  EXPECT_EQ(read_bytes(folder_.path() / "one" / "frame-0001.png"),
            read_bytes(folder_.path() / "three" / "frame-0001.png"));
}

TEST_F(DenoisedRun, PartsOfAFrameAreRefused) {
  expect_refused_run(joined({kAtrous, {"--slices", "2"}}), {"--slices", "denoise.filter=off"});
  expect_refused_run(joined({kAtrous, {"--tile-sampling", "auto"}}), {"--tile-sampling", "denoise.filter=off"});
  expect_refused_run(joined({kAtrous, {"--program", "reconstruct"}}), {"denoise.filter", "full:N"});
}

}  // namespace
}  // namespace test
