#include <array>
#include <filesystem>
#include <string>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/tools/program.h"

// Tests of runs, traces and verification with a predictor (tni.predictor), and of what cannot be combined with it.

namespace test {
namespace {

using Json = nlohmann::json;

class PredictorRun : public testing::Test {
 protected:
  ProcessResult in_folder(Words words) const {
    words.insert(words.end(), {"--quiet"});
    return raywatt(words, {.folder = folder_.path()});
  }
  static Words with(Words words, const Words& more) {
    words.insert(words.end(), more.begin(), more.end());
    return words;
  }
  Json report(const std::string& run) const {
    Json json = read_json(folder_.path() / run / "report.json");
    json.erase("host");
    json["provenance"].erase("argv");
    return json;
  }
  TempFolder folder_;
  const Words small_{"--scene",      "chess",
                     "--resolution", "64x32",
                     "--set",        "scene.triangles=3000",
                     "--set",        "render.tile=8",
                     "--set",        "render.effects=occlusion, shadows"};
  const Words on_{"--set", "tni.predictor.enabled=true"};
};

TEST_F(PredictorRun, IsReplayedFromItsTraceAndAddsItsCountersAndEnergy) {
  ASSERT_EQ(in_folder(with(with({"run", "-o", "off"}, small_), {})).exit, 0);
  ASSERT_EQ(in_folder(with(with({"run", "-o", "on", "--threads", "3", "--record", "a.trace"}, small_), on_)).exit, 0);
  ASSERT_EQ(in_folder({"trace", "replay", "a.trace", "-o", "again"}).exit, 0);
  const Json off = report("off"), on = report("on");
  EXPECT_EQ(on, report("again"));
  EXPECT_EQ(read_bytes(folder_.path() / "off/image.exr").size(), read_bytes(folder_.path() / "on/image.exr").size());
  EXPECT_EQ(read_bytes(folder_.path() / "off/image.png"), read_bytes(folder_.path() / "on/image.png"));
  EXPECT_FALSE(off["units"]["core0"]["tni"].contains("predictor"));
  const Json counters = on["units"]["core0"]["tni"]["predictor"]["counters"];
  EXPECT_GT(counters["correct"], 0);
  EXPECT_GT(on["totals"]["energy_by_event_mj"]["tni"]["tni"]["predictor_lookup"], 0);
  EXPECT_LT(off["totals"]["area_by_part_mm2"]["arrays"], on["totals"]["area_by_part_mm2"]["arrays"]);
  expect_refusal(in_folder({"trace", "replay", "a.trace", "--set", "tni.predictor.enabled=false", "-o", "other"}),
                 {"tni.predictor.enabled"});
}

TEST_F(PredictorRun, LosesNoHit) {
  ASSERT_EQ(in_folder(with(with({"verify", "-o", "verified"}, small_), on_)).exit, 0);
  const Json json = read_json(folder_.path() / "verified/verify.json");
  EXPECT_EQ(json["missing_hits"], 0);
  EXPECT_EQ(json["extra_hits"], 0);
  EXPECT_EQ(json["distance_errors"], 0);
}

TEST_F(PredictorRun, IsRefusedWhereItCannotLearnOrHasNoNode) {
  const auto refused = [&](const Words& more, const Words& parts) {
    expect_refusal(in_folder(with(with(with({"run", "-o", "x"}, small_), on_), more)), parts);
  };
  refused({"--slices", "2"}, {"--slices: a predictor learns", "allowed: tni.predictor.enabled=false"});
  refused({"--tile-sampling", "50%"}, {"--tile-sampling: a predictor learns", "allowed: tni.predictor.enabled=false"});
  refused({"--set", "bvh.instances=two_level"}, {"tni.predictor.enabled", "allowed with it: bvh.instances=flatten"});
  refused({"--set", "tni.predictor.ways=16", "--set", "tni.predictor.entries=8"}, {"tni.predictor.ways: is 16"});
  const std::array<float, 8> ray{0, 0, 0, 0, 0, 0, 1, 1};  // origin, t_min, direction, t_max
  folder_.write("some.rays", std::string(reinterpret_cast<const char*>(ray.data()), sizeof ray));
  expect_refusal(in_folder({"run", "--rays", "some.rays", "-o", "x", "--set", "tni.predictor.enabled=true"}),
                 {"--rays: a list of rays has no tiles", "allowed: tni.predictor.enabled=false"});
}

}  // namespace
}  // namespace test
