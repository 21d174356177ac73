#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/tools/program.h"
#include "tests/tools/studies/compare/compare_harness.h"

// Tests of differences between runs and their noise.

namespace test {
namespace {

using Json = nlohmann::json;

TEST_F(Runs, UseTheAssumedNoiseWithoutReplicates) {
  const Json c = compared("base", "ports");
  const Json& noise = c["figures"]["cycles"]["noise"];
  EXPECT_EQ(noise["from"], "default");
  EXPECT_NEAR(noise["half_width"].get<double>(), 0.25, 0.025);
  EXPECT_EQ(noise["outside"], std::abs(noise["difference"].get<double>()) > noise["half_width"].get<double>());
  EXPECT_FALSE(c["figures"]["rays"].contains("noise")) << "rays are counted, whatever races there are";
  EXPECT_SAYS(raywatt({"compare", path("base"), path("ports")}).out,
              "noise: assumed for this size of picture; --replicates 5");
}

TEST_F(Runs, UseTheLargerNoiseIfOneHasReplicates) {
  const std::string noisy = changed("noisy.json", [](Json& report) {
    const double cycles = report["totals"]["cycles"];
    report["totals"]["replicates"] = {{"count", 4},
                                      {"figures", {{"cycles", {{"mean", cycles}, {"deviation", 0.2 * cycles}}}}}};
  });
  const Json one = Json::parse(raywatt({"compare", noisy, path("ports"), "--json"}).out);
  const Json noise = one["against"][0]["figures"]["cycles"]["noise"];
  EXPECT_EQ(noise["from"], "default");
  // Noise of the mean of four replicates, and of one replicate with the same deviation.
  EXPECT_NEAR(noise["half_width"].get<double>(), 1.96 * 0.2 * std::hypot(0.5, 1), 0.05);
  EXPECT_SAYS(raywatt({"compare", noisy, path("ports")}).out, "or of one run's replicates if larger; --replicates 5");
  const std::string tripled = changed("tripled.json", [](Json& report) {
    const double cycles = report["totals"]["cycles"];
    report["totals"]["replicates"] = {{"count", 4},
                                      {"figures", {{"cycles", {{"mean", 3 * cycles}, {"deviation", cycles}}}}}};
  });
  EXPECT_SAYS(raywatt({"compare", path("base"), tripled}).out, "=  mean x3 ± ") << "whatever the first plays say";
}

TEST_F(Runs, WithOtherClocksHaveNoVerdictOnCycles) {
  const std::string slow = changed("slow.json", [](Json& report) { report["config"]["clocks"]["tni"] = "400 MHz"; });
  const ProcessResult ending = raywatt({"compare", path("base"), slow});
  EXPECT_SAYS(ending.err, "have different T&I clocks (clocks.tni): compare times, not cycles");
  EXPECT_SAYS(ending.out, "another clock");
  const Json c = Json::parse(raywatt({"compare", path("base"), slow, "--json"}).out)["against"][0];
  EXPECT_FALSE(c["figures"]["cycles"].contains("noise"));
  EXPECT_TRUE(c["figures"]["time_ms"].contains("noise"));
}

TEST_F(Runs, AreSimulatedAgainForTheirNoise) {
  const ProcessResult ending = raywatt({"compare", path("base"), path("ports"), "--replicates", "3", "--json"});
  ASSERT_EQ(ending.exit, 0) << ending.err;
  const Json cycles = Json::parse(ending.out)["against"][0]["figures"]["cycles"];
  EXPECT_EQ(cycles["noise"]["from"], "replicates");
  const Json plain = compared("base", "ports")["figures"]["cycles"];
  EXPECT_EQ(cycles["a"], plain["a"]) << "figures stay those of the runs";
  EXPECT_NE(cycles["noise"]["half_width"], plain["noise"]["half_width"]);
  const std::string other = changed("other.json", [](Json& report) { report["totals"]["cycles"] = 7; });
  expect_refusal(raywatt({"compare", path("base"), other, "--replicates", "2", "--progress", "none"}),
                 {"other.json: has 7 cycles, but a repetition takes "});
}

TEST_F(Runs, UseTheirReplicatesIfBothHaveThem) {
  const auto replicated = [&](double mean) {
    return [mean](Json& report) {
      report["totals"]["replicates"] = {{"count", 5}, {"figures", {{"cycles", {{"mean", mean}, {"deviation", 2.0}}}}}};
    };
  };
  const std::string a = changed("a.json", replicated(1000)), near = changed("near.json", replicated(1001)),
                    far = changed("far.json", replicated(1010));
  const auto noise = [&](const std::string& b) {
    return Json::parse(raywatt({"compare", a, b, "--json"}).out)["against"][0]["figures"]["cycles"]["noise"];
  };
  EXPECT_EQ(noise(near)["outside"], false);
  EXPECT_EQ(noise(far)["outside"], true);
  EXPECT_EQ(noise(far)["from"], "replicates");
  EXPECT_NEAR(noise(far)["difference"].get<double>(), 0.01, 1e-12);
  EXPECT_NEAR(noise(far)["half_width"].get<double>(), 2.306004 * std::sqrt(8.0 / 5) / 1000,
              1e-8);  // Student's t with eight degrees of freedom
  EXPECT_SAYS(raywatt({"compare", a, far}).out, "mean +1.00 % ± 0.29 %, outside");
  EXPECT_SAYS(raywatt({"compare", path("base"), path("ports")}).out,
              "The difference itself is within run-to-run noise.")
      << "a draw's interval knows nothing of the noise";
}

}  // namespace
}  // namespace test
