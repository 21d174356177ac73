#include <cstdint>
#include <map>
#include <sstream>
#include <string>
#include <string_view>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/tools/program.h"

// Tests of adaptive sampling: sample counts in report.json, and rates that carry over from frame to frame.

namespace test {
namespace {

using Json = nlohmann::json;

Json report_of_program(const std::filesystem::path& out, const std::string& program, const Words& more = {}) {
  Words words = small_run(out, {"--program", program});
  words.insert(words.end(), more.begin(), more.end());
  const ProcessResult ending = raywatt(words);
  EXPECT_EQ(ending.exit, 0) << ending.err;
  return read_json(out / "report.json");
}

class AdaptiveRun : public testing::TestWithParam<const char*> {
 protected:
  const TempFolder folder_;
};
INSTANTIATE_TEST_SUITE_P(Programs, AdaptiveRun, testing::Values("multirate:under", "multirate:super", "undersample"),
                         [](const auto& i) {
                           std::string name = i.param;
                           if (const std::size_t colon = name.find(':'); colon != std::string::npos) name[colon] = '_';
                           return name;
                         });

TEST_P(AdaptiveRun, ReportsItsSamples) {
  // Adjacent pixels of such a small picture are far apart in the scene.
  const Json report = report_of_program(folder_.path() / "out", GetParam(), {"--set", "undersample.position=0.2"});
  EXPECT_EQ(report["program"], GetParam());
  const Json& totals = report["totals"];
  const Json& s = totals["sampling"];
  const auto count = [&](const char* name) { return s[name].get<std::uint64_t>(); };
  EXPECT_EQ(count("wanted"), std::string(GetParam()) == "multirate:super" ? 4U * 64 * 32 : 64U * 32);
  EXPECT_EQ(count("traced"), count("wanted") - count("passed") + count("halo") + count("correction"));
  EXPECT_LT(count("checked"), count("wanted"));
  EXPECT_DOUBLE_EQ(totals["traced_ratio"], static_cast<double>(count("traced")) / static_cast<double>(count("wanted")));
  EXPECT_DOUBLE_EQ(s["similar_ratio"], static_cast<double>(count("passed")) / static_cast<double>(count("checked")));
  EXPECT_LT(totals["traced_ratio"], 1);
  std::uint64_t failures = 0;
  for (const auto& [check, failed] : s["failed"].items()) failures += failed.get<std::uint64_t>();
  EXPECT_GE(failures, count("checked") - count("passed")) << "who fails does so by one check or more";
  EXPECT_GT(s["failed"]["object"], 0);
  std::uint64_t first = 0;
  for (const auto& [check, failed] : s["first_failed"].items()) {
    first += failed.get<std::uint64_t>();
    EXPECT_LE(failed, s["failed"][check]) << check;
  }
  EXPECT_EQ(first, count("checked") - count("passed") + s["failed"]["border"].get<std::uint64_t>());
  EXPECT_EQ(s["first_failed"]["object"], s["failed"]["object"]) << "it is the first check";
  EXPECT_GE(totals["rays"]["primary"].get<std::uint64_t>(), count("traced"));
  EXPECT_GT(totals["dram_bytes_by_client"]["samples"], 0) << "halos";
}

TEST_P(AdaptiveRun, DoesNotDependOnTheThreadsOfTheHost) {
  const auto out = [&](const char* threads) {
    const std::filesystem::path path = folder_.path() / threads;
    const ProcessResult ending =
        raywatt({"run", "--program", GetParam(), "--resolution", "64x32", "--threads", threads, "-o", path.string()});
    EXPECT_EQ(ending.exit, 0) << ending.err;
    return path;
  };
  const std::filesystem::path one = out("1");
  for (const char* threads : {"2", "3"}) {
    const std::filesystem::path other = out(threads);
    EXPECT_EQ(repeatable(read_json(other / "report.json")), repeatable(read_json(one / "report.json"))) << threads;
    for (const char* name : {"image.png", "image.exr", "report.txt", "config.yaml"}) {
      EXPECT_EQ(read_bytes(other / name), read_bytes(one / name)) << name << ", " << threads << " threads";
    }
  }
}

TEST_P(AdaptiveRun, ItsConfigurationLoadsAgainAndGivesTheSameRun) {
  const Json first = report_of_program(folder_.path() / "first", GetParam(),
                                       {"--set", "undersample.correction=four", "--set", "multirate.halo=retrace"});
  const std::filesystem::path out = folder_.path() / "second";
  const ProcessResult ending = raywatt(
      {"run", (folder_.path() / "first" / "config.yaml").string(), "--program", GetParam(), "-o", out.string()});
  ASSERT_EQ(ending.exit, 0) << ending.err;
  EXPECT_EQ(repeatable(read_json(out / "report.json")), repeatable(first));
}

/// Returns the shares of the printed reasons for tracing, by name.
std::map<std::string, double> reasons_of(const std::filesystem::path& out) {
  const std::string table = read_bytes(out / "report.txt");
  const std::string title = "traced because of";
  std::size_t at = table.find(title);
  EXPECT_NE(at, std::string::npos);
  std::istringstream line(table.substr(at + title.size(), table.find('\n', at) - at - title.size()));
  std::map<std::string, double> shares;
  for (std::string name, percent; line >> name; line >> percent) line >> shares[name];
  return shares;
}

TEST(TracingReasons, AreSharesOfAllTracedSamples) {
  const TempFolder folder;
  for (const char* program : {"multirate:under", "undersample", "supersample"}) {
    const Json report =
        report_of_program(folder.path() / "out", program, {"--set", "supersample.propagate=2", "--force"});
    const std::map<std::string, double> shares = reasons_of(folder.path() / "out");
    double sum = 0;
    for (const auto& [name, share] : shares) sum += share;
    EXPECT_NEAR(sum, 100, 0.1 * static_cast<double>(shares.size())) << program;
    EXPECT_GT(shares.at("object"), 0) << program;
    EXPECT_GT(shares.at(std::string_view(program) == "supersample" ? "centres" : "references"), 0) << program;
    const Json& s = report["totals"]["sampling"];
    EXPECT_EQ(shares.contains("correction"), s["correction"] != 0) << program;
  }
}

/// Sample counts of a frame.
std::uint64_t references(const Json& frame) {
  const Json& s = frame["sampling"];
  return s["wanted"].get<std::uint64_t>() - s["checked"].get<std::uint64_t>() -
         s["failed"]["border"].get<std::uint64_t>();
}

/// Returns the sample counts of several frames of a static view with 128 x 64 pixels.
Json frames_of(const std::filesystem::path& out, const Words& more) {
  Words words = {"run",       "--scene",         "teapot",    "--frames", "0:3", "--resolution", "128x64",
                 "--program", "multirate:under", "--threads", "1",        "-o",  out.string()};
  words.insert(words.end(), more.begin(), more.end());
  const ProcessResult ending = raywatt(words);
  EXPECT_EQ(ending.exit, 0) << ending.err;
  Json frames = read_json(out / "report.json")["frames"];
  EXPECT_EQ(frames.size(), 4U);
  return frames;
}

TEST(Rates, GoOnFromFrameToFrameOfAStaticView) {
  const TempFolder folder;
  const Json frames = frames_of(folder.path() / "out", {"--set", "multirate.rate_control=hysteresis", "--set",
                                                        "render.tile=16"});  // some tiles show little
  EXPECT_EQ(references(frames[0]), 128U * 64 / 4) << "blocks of 2";
  EXPECT_LT(references(frames[1]), references(frames[0])) << "some tiles have blocks of 4";
  EXPECT_LT(frames[1]["traced_ratio"], frames[0]["traced_ratio"]);
  for (const Json& frame : frames) EXPECT_GT(frame["dram_bytes_by_client"]["rates"], 0);
}

TEST(Rates, StayWhereTheyAreWithoutControl) {
  const TempFolder folder;
  const Json frames = frames_of(folder.path() / "out", {});
  for (const Json& frame : frames) {
    EXPECT_EQ(references(frame), 128U * 64 / 4);
    EXPECT_EQ(frame["sampling"], frames[0]["sampling"]);
    EXPECT_FALSE(frame["dram_bytes_by_client"].contains("rates"));
  }
}

TEST(Rates, NeedBlocksOfTwo) {
  const TempFolder folder;
  expect_refusal(raywatt(small_run(folder.path() / "out", {"--program", "multirate:under", "--set", "multirate.block=3",
                                                           "--set", "multirate.rate_control=hysteresis"})),
                 {"multirate.block", "rate_control"});
}

TEST(Undersample, SamplesMustBeASquare) {
  const TempFolder folder;
  expect_refusal(
      raywatt(small_run(folder.path() / "out", {"--program", "undersample", "--set", "undersample.samples=8"})),
      {"undersample.samples", "square"});
}

}  // namespace
}  // namespace test
