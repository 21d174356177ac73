#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "sim/report/table.h"
#include "tests/tools/program.h"

// Tests of `raywatt run --replicates`.

namespace test {
namespace {

using Json = nlohmann::json;

Json replicated_report(const std::filesystem::path& out, const Words& more) {
  const ProcessResult ending = raywatt(small_run(out, more));
  EXPECT_EQ(ending.exit, 0) << ending.err;
  return read_json(out / "report.json");
}

TEST(ReplicatesOption, AddsStatisticsAndChangesNothingElse) {
  const TempFolder folder;
  Json plain = replicated_report(folder.path() / "plain", {}),
       five = replicated_report(folder.path() / "five", {"--replicates", "5"});
  const Json statistics = five["totals"]["replicates"];
  for (Json* totals : {&five["totals"], &five["frames"][0]}) totals->erase("replicates");
  for (const char* part : {"totals", "frames", "units", "config"}) EXPECT_EQ(plain[part], five[part]) << part;

  EXPECT_EQ(statistics["count"], 5);
  const Json& cycles = statistics["figures"]["cycles"];
  EXPECT_EQ(cycles["values"][0], plain["totals"]["cycles"].get<double>());
  double sum = 0;
  for (const Json& value : cycles["values"]) sum += value.get<double>();
  EXPECT_DOUBLE_EQ(cycles["mean"].get<double>(), sum / 5);
  EXPECT_GT(cycles["deviation"].get<double>(), 0);
  EXPECT_NEAR(cycles["high"].get<double>() - cycles["low"].get<double>(),
              2 * 2.776445 * cycles["deviation"].get<double>() / std::sqrt(5.0), 1e-3);
  for (const char* path : {"/energy_mj/nominal", "/power_w/nominal", "/perf/frames_per_joule_gpu", "/time_ms"}) {
    EXPECT_EQ(statistics["figures"].at(Json::json_pointer(path))["values"].size(), 5U) << path;
  }
}

TEST(ReplicatesOption, AreATableOfMeanDeviationAndIntervalForPeople) {
  const TempFolder folder;
  const auto out = folder.path() / "out";
  const Json figures = replicated_report(out, {"--replicates", "3"})["totals"]["replicates"]["figures"];
  const std::string text = read_bytes(out / "report.txt");
  EXPECT_SAYS(text, "3 runs ");
  for (const char* name : {"cycles", "perf.fps", "energy_mj.nominal", "power_w.nominal", "perf.frames_per_joule_gpu"}) {
    std::string pointer = std::string("/") + name;
    std::ranges::replace(pointer, '.', '/');
    const std::size_t line = text.find("\n" + std::string(name) + " ");
    ASSERT_NE(line, std::string::npos) << name;
    const std::string row = text.substr(line, text.find('\n', line + 1) - line);
    for (const char* part : {"mean", "deviation", "low", "high"}) {
      EXPECT_SAYS(row, " " + sim::four_digit_text(figures.at(Json::json_pointer(pointer))[part].get<double>())) << part;
    }
  }
}

TEST(ReplicatesOption, CoverEveryMetricThatTheyChange) {
  // Exceptions are values that only explain metrics of the frame, such as energies by event and cycles by kernel.
  const TempFolder folder;
  const Json totals = replicated_report(folder.path() / "out", {"--replicates", "3"})["totals"];
  const Json figures = totals["replicates"]["figures"].flatten(), flat = totals.flatten();
  std::size_t covered = 0;
  for (const auto& [path, value] : flat.items()) {
    const auto is_below = [&path = path](const char* group) { return path.starts_with(group); };
    if (!value.is_number() || is_below("/replicates") || is_below("/kernels") || is_below("/energy_by_event_mj") ||
        is_below("/top_down/cores") || is_below("/rays") || is_below("/sampling") || is_below("/area")) {
      continue;
    }
    const bool is_exact = path == "/traversal_steps" || path == "/traced_ratio" || path == "/extrapolated" ||
                          path == "/dram_bytes_by_client/frame_buffer";
    EXPECT_EQ(figures.contains(path + "/mean"), !is_exact) << path;
    covered += figures.contains(path + "/mean") ? 1 : 0;
  }
  EXPECT_GT(covered, 60U);
}

TEST(ReplicatesOption, OfSeveralFramesAreOfTheirSum) {
  const TempFolder folder;
  const Json r = replicated_report(folder.path() / "out", {"--scene", "car", "--frames", "0:1", "--replicates", "3"});
  const auto value = [](const Json& totals, std::size_t i) {
    return totals["replicates"]["figures"]["cycles"]["values"][i].get<double>();
  };
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(value(r["totals"], i), value(r["frames"][0], i) + value(r["frames"][1], i)) << i;
  }
}

TEST(ReplicatesOption, WithAReferenceCoverWhatIsRelativeToIt) {
  const TempFolder folder;
  const Json r =
      replicated_report(folder.path() / "out", {"--program", "full:4", "--reference", "full:1", "--replicates", "2"});
  const Json& speedup = r["totals"]["replicates"]["figures"]["relative"]["speedup"];
  EXPECT_EQ(speedup["values"][0], r["totals"]["relative"]["speedup"]);
  EXPECT_NE(speedup["values"][0], speedup["values"][1]);
}

TEST(ReplicatesOption, IsRefusedWhereTilesAreSampled) {
  const TempFolder folder;
  const Words more = {"--replicates", "3", "--tile-sampling", "5%"};
  expect_refusal(raywatt(small_run(folder.path() / "out", more)), {"--replicates", "--tile-sampling"});
}

/// Counts speed-ups that are greater than their noise, and checks the noise of each.
std::size_t count_significant_speedups(const std::string& text, const char* from, int plays) {
  std::size_t outside = 0;
  const Json found = Json::parse(text);
  for (const auto& [resource, bound] : found["bounds"].items()) {
    const Json& noise = bound["noise"];
    EXPECT_EQ(noise["from"], from) << resource;
    EXPECT_EQ(noise["plays"], plays) << resource;
    const double gain = noise["speedup"].get<double>() - 1, half = noise["half_width"].get<double>();
    EXPECT_GT(half, 0) << resource;
    EXPECT_EQ(noise["outside"].get<bool>(), std::abs(gain) > half) << resource;
    outside += noise["outside"].get<bool>() ? 1 : 0;
  }
  return outside;
}

Json without_noise(const std::string& text) {
  Json found = Json::parse(text);
  for (Json& bound : found["bounds"]) bound.erase("noise");
  return found;
}

TEST(ReplicatesOption, OfBottleneckReportsTheSpeedupsOutsideTheNoise) {
  const Words plain = {"bottleneck", "--resolution", "32x16", "--progress", "none", "--json"};
  Words replicated = plain;
  replicated.insert(replicated.end(), {"--replicates", "3"});
  const std::size_t outside = count_significant_speedups(raywatt(replicated).out, "replicates", 3);
  EXPECT_GT(outside, 0U) << "something limits the frame";
  EXPECT_GE(outside, count_significant_speedups(raywatt(plain).out, "default", 1)) << "the assumed noise is the wider";
  EXPECT_EQ(without_noise(raywatt(plain).out), without_noise(raywatt(replicated).out));
}

TEST(ReplicatesOption, MissingOfBottleneckLeavesTheAssumedNoise) {
  const std::string table = raywatt({"bottleneck", "--resolution", "32x16", "--progress", "none"}).out;
  EXPECT_SAYS(table, "noise, assumed");
  EXPECT_SAYS(table, "noise: assumed for this size of picture; --replicates 5 measures it");
  EXPECT_SAYS(table, "within");
}

}  // namespace
}  // namespace test
