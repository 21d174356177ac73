#include "tools/sampling/slices.h"

#include <cmath>
#include <numeric>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "sim/error.h"
#include "tests/tools/program.h"
#include "tools/sampling/pilot.h"
#include "traces/accel/bvh_tracer.h"

// Compares sliced frames with the same frames simulated as a whole.

namespace tools {
namespace {

/// A frame of 1600 tiles of 16 samples, on two cores.
const Inputs& teapot_tiles() {
  static const Inputs in = [] {
    JobOptions options;
    options.scene = "teapot";
    options.resolution = "160x160";
    options.sets = {"cores=2", "render.tile=4", "l2.size=32 KiB"};
    return load_inputs(options);
  }();
  return in;
}

const kernels::ProgramSpec kFull = kernels::parse_program("full:1");

const FrameResult& uncut_teapot() {
  static const FrameResult s = simulate_frame(teapot_tiles(), kFull, 1);
  return s;
}

const FrameResult& eight_slices() {
  static const FrameResult s = simulate_slices(teapot_tiles(), kFull, 1, 8);
  return s;
}

/// Returns the first value in which two runs differ; empty if none.
std::string first_difference(const FrameResult& a, const FrameResult& b) {
  if (a.cycles != b.cycles || a.elapsed != b.elapsed) return "cycles";
  for (std::size_t u = 0; u < a.units.size(); ++u) {
    if (a.units[u].elapsed != b.units[u].elapsed || a.units[u].cycles_by_reason != b.units[u].cycles_by_reason)
      return a.units[u].path;
    for (std::size_t i = 0; i < a.units[u].counters.size(); ++i) {
      if (a.units[u].counters[i].value != b.units[u].counters[i].value)
        return a.units[u].path + "." + a.units[u].counters[i].name;
    }
  }
  for (std::size_t k = 0; k < a.kernel_use.size(); ++k) {
    if (a.kernel_use[k].cycles != b.kernel_use[k].cycles) return "kernel " + std::to_string(k);
  }
  if (a.rendered.rgb != b.rendered.rgb || a.rays() != b.rays()) return "function";
  return a.energy.total_pj.nominal == b.energy.total_pj.nominal ? "" : "energy";
}

double counted(const FrameResult& s, const std::string& name) {
  double sum = 0;
  for (const sim::UnitReport& unit : s.units) {
    for (const sim::CounterReport& counter : unit.counters)
      sum += counter.name == name ? static_cast<double>(counter.value) : 0;
  }
  return sum;
}

TEST(Slices, CostsAreEstimatedFromStepsAndRaysThatSurfacesSendOn) {
  const RenderResult& function = uncut_teapot().rendered;
  const auto rays = [&](traces::RayKind kind) { return function.rays[static_cast<std::size_t>(kind)]; };
  const double all = static_cast<double>(
      function.traversal_steps + 15 * (rays(traces::RayKind::kReflection) + rays(traces::RayKind::kRefraction)));
  const traces::BvhTracer tracer(teapot_tiles().image);
  const std::vector<double> costs = estimate_costs(teapot_tiles(), kFull, tracer, 2);
  EXPECT_EQ(costs.size(), 1600U);
  EXPECT_NEAR(16 * std::accumulate(costs.begin(), costs.end(), 0.0), all, 0.1 * all) << "one of 16 samples";
}

TEST(Slices, OneSliceIsThePlainRunToTheLastCounter) {
  EXPECT_EQ(first_difference(uncut_teapot(), simulate_slices(teapot_tiles(), kFull, 2, 1)), "");
}

TEST(Slices, OfPathsHaveThePictureOfTheWholeFrame) {
  const kernels::ProgramSpec paths = kernels::parse_program("path:1");
  const FrameResult whole = simulate_frame(teapot_tiles(), paths, 2),
                    sliced = simulate_slices(teapot_tiles(), paths, 2, 4);
  EXPECT_EQ(sliced.rendered.rgb, whole.rendered.rgb);
  EXPECT_EQ(sliced.rays(), whole.rays());
}

TEST(Slices, NothingDependsOnTheNumberOfThreads) {
  for (const std::uint32_t threads : {3U, 20U}) {
    const FrameResult s = simulate_slices(teapot_tiles(), kFull, threads, 8);
    EXPECT_EQ(first_difference(eight_slices(), s), "") << threads;
    EXPECT_EQ(s.sliced->cycles.half_width(), eight_slices().sliced->cycles.half_width());
  }
}

TEST(Slices, ShorterThanTheirLeadsAddUpToo) {
  constexpr std::uint32_t kSlices = 90;  // each has 17 or 18 tiles, and a lead of 20
  const FrameResult one = simulate_slices(teapot_tiles(), kFull, 1, kSlices);
  const FrameResult three = simulate_slices(teapot_tiles(), kFull, 3, kSlices);
  EXPECT_EQ(first_difference(one, three), "");
  EXPECT_EQ(one.rendered.traversal_steps, uncut_teapot().rendered.traversal_steps);
  EXPECT_GT(one.sliced->again, (kSlices - 2) * 17U) << "longer than slices";
  EXPECT_NEAR(one.sliced->cycles.estimate, static_cast<double>(uncut_teapot().cycles), one.sliced->cycles.half_width());
}

TEST(Slices, ThePictureAndAllThatIsCountedOfItAreTheWholeFrames) {
  const FrameResult &whole = uncut_teapot(), &cut = eight_slices();
  EXPECT_EQ(cut.rendered.rgb, whole.rendered.rgb);
  EXPECT_EQ(cut.rendered.traversal_steps, whole.rendered.traversal_steps);
  EXPECT_EQ(cut.rendered.sampling.background, whole.rendered.sampling.background);
  for (std::size_t k = 0; k < std::size(whole.rendered.rays); ++k)
    EXPECT_EQ(cut.rendered.rays[k], whole.rendered.rays[k]);
}

/// Returns eight slices, each simulated alone and then written to text and read again.
const std::vector<sim::Json>& eight_parts() {
  static const std::vector<sim::Json> parts = [] {
    std::vector<sim::Json> all(8);
    for (std::uint32_t i = 8; i-- != 0;)
      all[i] = sim::parse_json(sim::json_line(simulate_slice(teapot_tiles(), kFull, i % 3 + 1, 8, i)));
    return all;
  }();
  return parts;
}

TEST(Slices, PlayedEachAloneTheyAddUpToTheSameFrameToTheLastCounter) {
  FrameResult joined = join_slices(teapot_tiles(), kFull, eight_parts());
  joined.rendered.rgb = eight_slices().rendered.rgb;
  EXPECT_EQ(first_difference(eight_slices(), joined), "");
  EXPECT_EQ(joined.sliced->cycles.half_width(), eight_slices().sliced->cycles.half_width());
  EXPECT_EQ(joined.sliced->energy_pj.half_width(), eight_slices().sliced->energy_pj.half_width());
  EXPECT_EQ(joined.rendered.sampling.background, eight_slices().rendered.sampling.background);
}

TEST(Slices, WhatIsNoSliceOfTheFrameIsNotJoined) {
  const auto refused = [](auto&& damage) {
    std::vector<sim::Json> parts = eight_parts();
    damage(parts);
    try {
      join_slices(teapot_tiles(), kFull, parts);
    } catch (const sim::InputError& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  EXPECT_SAYS(refused([](auto& p) { std::swap(p[2], p[3]); }), "do not follow");
  EXPECT_SAYS(refused([](auto& p) { p.pop_back(); }), "do not follow");
  EXPECT_SAYS(refused([](auto& p) { p[1]["tiles"]["end"] = std::uint64_t{1} << 40; }), "end is no whole number");
  EXPECT_SAYS(refused([](auto& p) { p[1]["units"][3]["path"] = "gpu"; }), "there is no unit");
  EXPECT_SAYS(refused([](auto& p) { p[1]["units"][3]["counters"].push_back(1); }), "counters are no list of");
  EXPECT_SAYS(refused([](auto& p) { p[1]["units"][3]["why"][0] = -1; }), "no whole number");
  EXPECT_SAYS(refused([](auto& p) { p[1]["before"]["time"] = "long"; }), "an amount is no number");
  EXPECT_SAYS(refused([](auto& p) { p[1].erase("function"); }), "function");
}

TEST(Slices, TheTruthIsInNearlyAllIntervals) {
  int inside = 0;
  const auto look = [&](const Interval& interval, double truth) {
    inside += std::abs(interval.estimate - truth) <= interval.half_width() ? 1 : 0;
    EXPECT_NEAR(interval.estimate, truth, 0.02 * truth);
    EXPECT_LT(interval.half_width(), 0.05 * truth);
  };
  for (const std::uint32_t slices : {2U, 8U, 32U}) {
    const FrameResult s = simulate_slices(teapot_tiles(), kFull, 1, slices);
    look(s.sliced->cycles, static_cast<double>(uncut_teapot().cycles));
    look(s.sliced->energy_pj, uncut_teapot().energy.total_pj.nominal);
  }
  EXPECT_GE(inside, 5) << "of 6";
}

TEST(Slices, CountersAddUpToThoseOfTheWholeFrame) {
  for (const char* name :
       {"dispatched", "visits", "tests", "items", "picture_lines_written", "active_standby", "latency", "fed"}) {
    const double whole = counted(uncut_teapot(), name);
    EXPECT_GT(whole, 0) << name;
    EXPECT_NEAR(counted(eight_slices(), name), whole, 0.02 * whole) << name;
  }
}

TEST(Slices, EveryUnitsReasonsSumToItsTimeWhichIsTheFrames) {
  for (std::size_t u = 0; u < eight_slices().units.size(); ++u) {
    const sim::UnitReport &cut = eight_slices().units[u], &whole = uncut_teapot().units[u];
    std::uint64_t sum = 0;
    for (const auto& [reason, cycles] : cut.cycles_by_reason) sum += cycles;
    EXPECT_EQ(sum, cut.elapsed) << cut.path;
    const double frames = static_cast<double>(whole.elapsed) * static_cast<double>(eight_slices().elapsed) /
                          static_cast<double>(uncut_teapot().elapsed);
    EXPECT_NEAR(static_cast<double>(cut.elapsed), frames, 7 * 100) << cut.path << ": units stand apart at borders";
  }
}

TEST(Slices, AutoGivesEachTenTimesTheTilesThatFillItsMachine) {
  EXPECT_EQ(slice_count(teapot_tiles().config, kFull, kAutoSlices), 16U) << "1600 tiles, 10 fill it";
  EXPECT_EQ(slice_count(teapot_tiles().config, kFull, 160), 160U);
  EXPECT_THROW(slice_count(teapot_tiles().config, kFull, 161), sim::InputError);
  JobOptions small;
  small.resolution = "64x64";
  EXPECT_EQ(slice_count(load_inputs(small).config, kFull, kAutoSlices), 1U);
}

TEST(Slices, OfFramesThatAreAddedUpChanceEvensOut) {
  SlicedFrame sum{.slices = 2, .tiles = 10, .again = 3, .cycles = {100, 3, 0}, .energy_pj = {}, .seconds = {1, 2}};
  sum.add({.slices = 2, .tiles = 10, .again = 3, .cycles = {200, 4, 0}, .energy_pj = {}, .seconds = {1, 2}});
  EXPECT_EQ(sum.tiles, 20U);
  EXPECT_EQ(sum.again, 6U);
  EXPECT_DOUBLE_EQ(sum.cycles.estimate, 300);
  EXPECT_DOUBLE_EQ(sum.cycles.half_width(), 5);
  EXPECT_DOUBLE_EQ(sum.seconds[1], 4);
}

TEST(Slices, NumbersAreReadAndOthersRefused) {
  EXPECT_EQ(parse_slices("16"), 16U);
  EXPECT_EQ(parse_slices("auto"), kAutoSlices);
  for (const char* bad : {"", "0", "-2", "2.5", "2 ", "two", "99999999999"}) {
    EXPECT_THROW(parse_slices(bad), sim::InputError) << bad;
  }
}

}  // namespace
}  // namespace tools

namespace test {
namespace {

TEST(SlicedRun, ReportsTheNumberOfSlicesAndTheInterval) {
  const TempFolder folder;
  const auto totals_of = [&](const char* slices) {
    const std::filesystem::path out = folder.path() / slices;
    const ProcessResult ending = raywatt({"run", "--resolution", "160x160", "--threads", "2", "--set", "render.tile=4",
                                          "--set", "cores=2", "--slices", slices, "-o", out.string()});
    EXPECT_EQ(ending.exit, 0) << ending.err;
    EXPECT_SAYS(ending.out, "slices");
    EXPECT_EQ(ending.out.find("±") != std::string::npos, std::string(slices) != "1");
    EXPECT_TRUE(std::filesystem::exists(out / "image.png"));
    return read_json(out / "report.json")["totals"];
  };
  const nlohmann::json totals = totals_of("4"), picked = totals_of("auto"), whole = totals_of("1");
  EXPECT_EQ(totals["sliced"]["slices"], 4);
  EXPECT_EQ(totals["sliced"]["tiles"], 1600);
  EXPECT_EQ(totals["sliced"]["again"], 3 * 10);
  EXPECT_EQ(totals["sliced"]["cycles"]["estimate"], totals["cycles"]);
  EXPECT_EQ(totals["sliced"]["energy_mj"]["estimate"], totals["energy_mj"]["nominal"]);
  EXPECT_LT(totals["sliced"]["time_ms"]["low"], totals["sliced"]["time_ms"]["high"]);
  EXPECT_EQ(picked["sliced"]["slices"], 16);
  EXPECT_EQ(whole["sliced"]["slices"], 1);
  EXPECT_FALSE(whole["sliced"].contains("cycles"));
}

TEST(SlicedRun, MachinesTakeAShareOfTheTimeOfSlicesForAnyThreads) {
  const TempFolder folder;
  for (const char* threads : {"2", "3"}) {  // 3: one machine has an extra thread that renders ahead
    const std::filesystem::path out = folder.path() / threads;
    const ProcessResult ending = raywatt({"run", "--resolution", "64x64", "--threads", threads, "--set",
                                          "render.tile=4", "--set", "cores=2", "--slices", "2", "-o", out.string()});
    ASSERT_EQ(ending.exit, 0) << ending.err;
    const nlohmann::json host = read_json(out / "report.json")["host"];
    EXPECT_GT(host["timing_s"], 0);
    EXPECT_LT(host["timing_s"], host["slices_s"][0].get<double>() + host["slices_s"][1].get<double>());
  }
}

TEST(SlicedRun, WhatMakesNoSenseIsRefusedBeforeAnythingIsMade) {
  expect_refused_run({"--slices", "some"}, {"nor auto"});
  expect_refused_run({"--slices", ""}, {"allowed: 2, auto"});
  expect_refused_run({"--slices", "500"}, {"at most"});
  expect_refused_run({"--slices", "2", "--program", "undersample"}, {"full:N"});
  expect_refused_run({"--slices", "2", "--set", "render.primary=raster"}, {"render.primary=rays"});
  expect_refused_run({"--slices", "2", "--set", "render.effects=occlusion", "--set", "render.effect_rate=half"},
                     {"render.effect_rate=full"});
  for (const Words& other : std::vector<Words>{{"--tile-sampling", "5%"},
                                               {"--reference", "full:1"},
                                               {"--replicates", "2"},
                                               {"--timeline", "all"},
                                               {"--record", "frame.trace"},
                                               {"--debug-images"}}) {
    Words words = {"--slices", "2"};
    words.insert(words.end(), other.begin(), other.end());
    expect_refused_run(words, {"--slices does not go with " + other.front()});
  }
}

}  // namespace
}  // namespace test
