#include <cmath>
#include <cstring>
#include <limits>
#include <numbers>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/temp_folder.h"
#include "tests/tools/program.h"

// Tests of runs on a list of rays instead of a camera, which use only T&I units, caches and memory.

namespace test {
namespace {

using Json = nlohmann::json;
using Floats = std::vector<float>;

std::string bytes_of(const Floats& floats) {
  std::string bytes(4 * floats.size(), '\0');
  std::memcpy(bytes.data(), floats.data(), bytes.size());
  return bytes;
}

/// Returns rays in all directions from a point in the Cornell box.
Floats fan(std::uint32_t count) {
  Floats floats;
  for (std::uint32_t i = 0; i < count; ++i) {
    const float turn = static_cast<float>(i) * 2.4F,
                height = 1 - 2 * (static_cast<float>(i) + 0.5F) / static_cast<float>(count);
    const float radius = std::sqrt(1 - height * height);
    floats.insert(floats.end(), {0, 1, 0, 0, radius * std::cos(turn), height, radius * std::sin(turn),
                                 std::numeric_limits<float>::infinity()});
  }
  return floats;
}

class Rays : public ::testing::Test {
 protected:
  std::string list(const Floats& floats) const { return folder_.write("a.rays", bytes_of(floats)).string(); }
  std::filesystem::path out() const { return folder_.path() / "out"; }
  Json report(const Floats& floats, const Words& more = {}) const {
    Words words = {"run", "--rays", list(floats), "-o", out().string()};
    words.insert(words.end(), more.begin(), more.end());
    const ProcessResult ending = raywatt(words);
    EXPECT_EQ(ending.exit, 0) << ending.err;
    EXPECT_SAYS(ending.out, "rays of a list");
    return read_json(out() / "report.json");
  }
  TempFolder folder_;
};

TEST_F(Rays, AreAllTracedByTheUnitsOfAllCoresAndNothingElseWorks) {
  const Json r = report(fan(1000));
  EXPECT_EQ(names_in(out()), (Words{"config.yaml", "report.json", "report.txt"}));
  EXPECT_EQ(r["schema"], "raywatt-rays/1");
  EXPECT_EQ(r["totals"]["rays"]["total"], 1000);
  EXPECT_GT(r["totals"]["rays"]["hits"], 500) << "the box is open to one side";
  EXPECT_LE(r["totals"]["rays"]["hits"], 1000);
  std::uint64_t rays = 0, visits = 0, tests = 0;
  for (int c = 0; c < 4; ++c) {
    const Json& core = r["units"]["core" + std::to_string(c)];
    EXPECT_FALSE(core.contains("srp"));
    tests += core["tni"]["ist"]["counters"]["tests"].get<std::uint64_t>();
    for (int t = 0; t < 4; ++t) {
      const Json& counters = core["tni"]["trv" + std::to_string(t)]["counters"];
      rays += counters["rays_out"].get<std::uint64_t>();
      visits += counters["visits"].get<std::uint64_t>() - counters["restarted_visits"].get<std::uint64_t>();
    }
  }
  EXPECT_EQ(rays, 1000U);
  EXPECT_EQ(visits + tests, r["totals"]["traversal_steps"]);
  EXPECT_GT(r["totals"]["energy_by_block_mj"]["tni"]["nominal"], 0);
  EXPECT_FALSE(r["totals"]["energy_by_block_mj"].contains("srp"));
}

TEST_F(Rays, ThatHitNothingAndAreShortAreCounted) {
  const Json r = report({0,   1,   0,   0, 0, 0,  1, 0,        // zero direction
                         500, 500, 500, 0, 1, 0,  0, 1e30F,    // outside, pointing away
                         0,   1,   0,   0, 0, -1, 0, 1e30F});  // to the floor
  EXPECT_EQ(r["totals"]["rays"]["hits"], 1);
}

TEST_F(Rays, AreFedAtTheIntervalOfTheDirectInterfaceAndNoFaster) {
  const Floats far = [] {
    Floats floats;
    for (int i = 0; i < 4096; ++i) floats.insert(floats.end(), {500, 500, 500, 0, 1, 0, 0, 1});
    return floats;
  }();
  const Json r = report(far, {"--set", "cores=1", "--set", "direct_interface.interval=8"});
  EXPECT_GE(r["totals"]["cycles"], 8 * 4095);
  EXPECT_LT(r["totals"]["cycles"], 8 * 4096 + 500) << "the first miss and the last ray's way";
}

TEST_F(Rays, AgreeWithEmbree) {
  const ProcessResult ending =
      raywatt({"verify", "--rays", list(fan(2000)), "-o", out().string(), "--progress", "json"});
  EXPECT_EQ(ending.exit, 0) << ending.err;
  EXPECT_SAYS(ending.err, "\"phase\":\"done\"");
  EXPECT_EQ(names_in(out()), Words{"verify.json"});
  const Json verdict = read_json(out() / "verify.json");
  EXPECT_EQ(verdict["rays"], 2000);
  EXPECT_EQ(verdict["partial"], false);
}

TEST_F(Rays, ThatAreNoneAreRefusedByTheirNumber) {
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN(), kInf = std::numeric_limits<float>::infinity();
  const Floats good = {0, 1, 0, 0, 0, 0, 1, 1};
  const auto refused = [&](std::size_t offset, float value, const std::string& says) {
    Floats bad = good;
    bad.insert(bad.end(), good.begin(), good.end());
    bad[8 + offset] = value;
    expect_refusal(raywatt({"run", "--rays", list(bad), "-o", out().string()}), {"a.rays: ray 1: ", says, "allowed"});
  };
  refused(1, kNan, "origin is not finite");
  refused(2, kInf, "origin is not finite");
  refused(4, -kInf, "direction is not finite");
  refused(6, 0, "direction is zero");
  refused(3, -1, "t_min");
  refused(3, 2, "t_max is less than t_min");
  refused(7, kNan, "t_max");
  folder_.write("a.rays", std::string(33, '\0'));
  expect_refusal(raywatt({"run", "--rays", (folder_.path() / "a.rays").string()}), {"has 33 bytes", "32 a ray"});
  folder_.write("a.rays", "");
  expect_refusal(raywatt({"run", "--rays", (folder_.path() / "a.rays").string()}), {"has 0 bytes", "at least one ray"});
  expect_refusal(raywatt({"run", "--rays", list(good), "--program", "full:4"}), {"--rays", "--program"});
  expect_refusal(raywatt({"run", "--rays", list(good), "--tile-sampling", "5%"}), {"--rays", "--tile-sampling"});
  EXPECT_FALSE(std::filesystem::exists(out()));
}

// Tests of rays of a list that end at their first hit.

TEST(AnyHit, FindsAsManyHitsInFewerSteps) {
  const TempFolder folder;
  const std::string rays = folder.write("a.rays", ray_list(2000)).string();
  const auto totals = [&](const Words& more) {
    Words words = {
        "run",    "--rays", rays, "--scene", "chess", "--json", "--quiet", "-o", (folder.path() / "out").string(),
        "--force"};
    words.insert(words.end(), more.begin(), more.end());
    const ProcessResult ending = raywatt(words);
    EXPECT_EQ(ending.exit, 0) << ending.err;
    return nlohmann::json::parse(ending.out);
  };
  const nlohmann::json nearest = totals({}), any = totals({"--any-hit"});
  EXPECT_GT(nearest["rays"]["hits"], 0);
  EXPECT_EQ(any["rays"]["hits"], nearest["rays"]["hits"]);
  EXPECT_LT(any["traversal_steps"], nearest["traversal_steps"]);
}

TEST(AnyHit, NeedsAListOfRays) { EXPECT_EQ(raywatt({"run", "--any-hit"}).exit, 2); }

}  // namespace
}  // namespace test
