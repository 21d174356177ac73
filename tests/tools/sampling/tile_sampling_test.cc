#include "tools/sampling/tile_sampling.h"

#include <cmath>
#include <cstdio>
#include <map>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "sim/error.h"
#include "tests/full_size.h"
#include "tests/tools/program.h"

// Compares sampled frames with the same frames simulated as a whole.

namespace tools {
namespace {

/// A frame of 1600 tiles of 16 samples, on two cores.
const Inputs& inputs() {
  static const Inputs in = [] {
    JobOptions options;
    options.scene = "teapot";
    options.resolution = "160x160";
    options.sets = {"cores=2", "render.tile=4", "l2.size=32 KiB"};
    return load_inputs(options);
  }();
  return in;
}

const kernels::ProgramSpec& program() {
  static const kernels::ProgramSpec spec = kernels::parse_program("full:1");
  return spec;
}

const FrameResult& whole() {
  static const FrameResult s = simulate_frame(inputs(), program(), 1);
  return s;
}

const FrameResult& sampled() {
  static const FrameResult s = simulate_sampled(inputs(), program(), 1, {});
  return s;
}

/// Returns the first value in which two runs differ; empty if none.
std::string difference(const FrameResult& a, const FrameResult& b) {
  if (a.cycles != b.cycles) return "cycles";
  for (std::size_t u = 0; u < a.units.size(); ++u) {
    if (a.units[u].elapsed != b.units[u].elapsed || a.units[u].cycles_by_reason != b.units[u].cycles_by_reason)
      return a.units[u].path;
    for (std::size_t i = 0; i < a.units[u].counters.size(); ++i) {
      if (a.units[u].counters[i].value != b.units[u].counters[i].value)
        return a.units[u].path + "." + a.units[u].counters[i].name;
    }
  }
  return a.energy.total_pj.nominal == b.energy.total_pj.nominal ? "" : "energy";
}

TEST(TileSampling, FarFromAllTilesAreTimed) {
  const SampledFrame& f = *sampled().sampled;
  EXPECT_EQ(f.tiles, 1600U);
  EXPECT_LT(f.timed, 600U);
  EXPECT_LT(f.measured, f.timed);
  EXPECT_GT(f.warmed, 0U);
}

TEST(TileSampling, TheTruthIsInTheIntervals) {
  const SampledFrame& f = *sampled().sampled;
  EXPECT_NEAR(f.cycles.estimate, static_cast<double>(whole().cycles), f.cycles.half_width());
  EXPECT_NEAR(f.energy_pj.estimate, whole().energy.total_pj.nominal, f.energy_pj.half_width());
  EXPECT_LT(f.cycles.half_width(), 0.1 * f.cycles.estimate);
  EXPECT_LT(f.energy_pj.half_width(), 0.1 * f.energy_pj.estimate);
}

TEST(TileSampling, AFrameTooSmallToSampleIsSimulatedWholeToTheLastCounter) {
  JobOptions options;
  options.resolution = "64x64";
  const Inputs small = load_inputs(options);
  const FrameResult a = simulate_frame(small, program(), 1), b = simulate_sampled(small, program(), 1, {});
  EXPECT_EQ(difference(a, b), "");
  EXPECT_EQ(b.sampled->timed, b.sampled->tiles);
  EXPECT_EQ(b.sampled->cycles.half_width(), 0);
  EXPECT_TRUE(b.sampled->counters.empty());
}

TEST(TileSampling, NothingDependsOnTheNumberOfThreads) {
  EXPECT_EQ(difference(sampled(), simulate_sampled(inputs(), program(), 3, {})), "");
}

TEST(TileSampling, EstimatesAreTheSameWithAndWithoutAPicture) {
  TileSampling sampling;
  sampling.full_image = false;
  const FrameResult blind = simulate_sampled(inputs(), program(), 2, sampling);
  EXPECT_EQ(difference(sampled(), blind), "");
  EXPECT_TRUE(blind.rendered.rgb.empty());
  EXPECT_NEAR(static_cast<double>(blind.rays()), static_cast<double>(whole().rays()),
              0.02 * static_cast<double>(whole().rays()));
}

TEST(TileSampling, ThePictureAndWhatWasTracedAreThoseOfTheWholeFrame) {
  EXPECT_EQ(sampled().rendered.rgb, whole().rendered.rgb);
  EXPECT_EQ(sampled().rays(), whole().rays());
  EXPECT_EQ(sampled().rendered.traversal_steps, whole().rendered.traversal_steps);
}

TEST(TileSampling, ReasonsOfEveryUnitSumToItsTime) {
  for (const sim::UnitReport& unit : sampled().units) {
    std::uint64_t spent = 0;
    for (const auto& [reason, cycles] : unit.cycles_by_reason) spent += cycles;
    EXPECT_EQ(spent, unit.elapsed) << unit.path;
    const double clocks = static_cast<double>(unit.elapsed) / unit.clock_mhz;
    EXPECT_NEAR(clocks, static_cast<double>(sampled().elapsed) / 1e9, 0.02 * clocks) << unit.path;
  }
}

TEST(TileSampling, CountersAreNearThoseOfTheWholeFrame) {
  const auto sum = [](const FrameResult& s, const char* kind, const char* name) {
    double total = 0;
    for (const sim::UnitReport& unit : s.units) {
      if (unit.path.find(kind) == std::string::npos) continue;
      for (const sim::CounterReport& counter : unit.counters) {
        if (counter.name == name) total += static_cast<double>(counter.value);
      }
    }
    return total;
  };
  const auto expect_near = [&](const char* kind, const char* name, double part) {
    const double truth = sum(whole(), kind, name);
    EXPECT_NEAR(sum(sampled(), kind, name), truth, part * truth) << kind << "." << name;
  };
  expect_near("trv", "visits", 0.03);
  expect_near("ist", "tests", 0.03);
  expect_near("srp", "items", 0.03);
  expect_near("dispatcher", "rays_in", 0.05);
  expect_near("dma", "picture_lines_written", 0.1);
  expect_near("bank", "latency", 0.2);  // filled in at the end of the run
}

TEST(TileSampling, AutoGoesOnUntilTheIntervalsAreNarrowEnough) {
  const TileSampling sampling = parse_tile_sampling("auto", "none");
  const FrameResult s = simulate_sampled(inputs(), program(), 1, sampling);
  const SampledFrame& f = *s.sampled;
  EXPECT_LE(f.cycles.half_width(), sampling.target * f.cycles.estimate);
  EXPECT_LE(f.energy_pj.half_width(), sampling.target * f.energy_pj.estimate);
  EXPECT_GT(f.rounds, 1U);
}

TEST(TileSampling, OfFramesThatAreAddedUpChanceEvensOutAndTheMethodDoesNot) {
  SampledFrame sum{.timed = 3, .cycles = {100, 3, 0}, .energy_pj = {10, 0, 1}, .counters = {{"dma.lines", {1, 0, 0}}}};
  sum.add({.timed = 4, .cycles = {200, 4, 0}, .energy_pj = {20, 0, 2}, .counters = {{"dma.lines", {2, 0, 0}}}});
  EXPECT_EQ(sum.timed, 7U);
  EXPECT_DOUBLE_EQ(sum.cycles.estimate, 300);
  EXPECT_DOUBLE_EQ(sum.cycles.half_width(), 5);
  EXPECT_DOUBLE_EQ(sum.energy_pj.half_width(), 3);
  EXPECT_DOUBLE_EQ(sum.counters["dma.lines"].estimate, 3);
}

TEST(TileSampling, CountersHaveIntervalsThatHoldTheTruth) {
  std::size_t inside = 0, all = 0;
  for (const auto& [path, truth] : summed_counters(whole().units)) {
    const Interval& estimate = sampled().sampled->counters.at(path);
    EXPECT_GE(estimate.half_width(), 0.01 * estimate.estimate) << path;
    if (truth < 1000) continue;  // rare events may fall between the blocks
    all += 1;
    if (std::abs(estimate.estimate - truth) <= estimate.half_width()) {
      inside += 1;
    } else {
      std::printf("%s: %.0f is outside of %.0f +- %.0f\n", path.c_str(), truth, estimate.estimate,
                  estimate.half_width());
    }
  }
  EXPECT_GT(all, 40U);
  EXPECT_GE(static_cast<double>(inside), 0.9 * static_cast<double>(all));
}

TEST(TileSampling, PeaksAreThoseOfWhatWasTimed) {
  const auto peaks = [](const FrameResult& s) {
    std::map<std::string, std::uint64_t> found;
    for (const sim::UnitReport& unit : s.units) {
      for (const sim::CounterReport& counter : unit.counters) {
        if (counter.kind == sim::CounterKind::kPeak) found[unit.path + "." + counter.name] = counter.value;
      }
    }
    return found;
  };
  const auto truth = peaks(whole());
  const hw::GpuConfig& gpu = *inputs().config.gpu;
  EXPECT_EQ(truth.size(), gpu.cores + gpu.dram.channels) << "slots of tile buffers, read latency of channels";
  for (const auto& [path, peak] : peaks(sampled())) {
    EXPECT_GT(peak, 0U) << path;
    EXPECT_LE(static_cast<double>(peak), 1.5 * static_cast<double>(truth.at(path))) << path;
  }
}

TEST(TileSampling, AutoThatTimesAllTilesInTheEndIsExactAndKeepsThePicture) {
  TileSampling sampling;
  sampling.target = 1e-6;
  const FrameResult s = simulate_sampled(inputs(), program(), 1, sampling);
  EXPECT_EQ(difference(s, whole()), "");
  EXPECT_EQ(s.rendered.rgb, whole().rendered.rgb);
  EXPECT_GT(s.sampled->rounds, 1U);
  EXPECT_EQ(s.sampled->timed, s.sampled->tiles);
  EXPECT_EQ(s.sampled->measured, s.sampled->tiles);
  EXPECT_EQ(s.sampled->cycles.half_width(), 0);
}

TEST(TileSampling, ALargeL2IsAsWarmAsInTheWholeFrame) {
  JobOptions options;
  options.scene = "conference";
  options.resolution = test::is_full_size() ? "512x256" : "256x256";
  options.sets = {"render.tile=8", "l2.size=8 MiB"};
  const Inputs large = load_inputs(options);
  const FrameResult a = simulate_frame(large, program(), 1), b = simulate_sampled(large, program(), 1, {});
  EXPECT_LT(b.sampled->timed, b.sampled->tiles);
  EXPECT_NEAR(b.sampled->cycles.estimate, static_cast<double>(a.cycles), b.sampled->cycles.half_width());
  EXPECT_NEAR(b.sampled->energy_pj.estimate, a.energy.total_pj.nominal, b.sampled->energy_pj.half_width());
}

TEST(TileSampling, SharesAreReadAndOthersRefused) {
  EXPECT_DOUBLE_EQ(parse_tile_sampling("5%", "full").share, 0.05);
  EXPECT_DOUBLE_EQ(parse_tile_sampling("12.5%", "full").share, 0.125);
  EXPECT_FALSE(parse_tile_sampling("5%", "none").full_image);
  for (const char* bad : {"", "5", "%", "0%", "101%", "nan%", "-5%", "5%%", "5 %", "Auto"}) {
    EXPECT_THROW(parse_tile_sampling(bad, "full"), sim::InputError) << bad;
  }
}

TEST(TileSampling, ProgramsWhoseTilesNeedOthersAreRefused) {
  EXPECT_NO_THROW(check_tile_sampling(kernels::parse_program("full:4")));
  for (const char* name : {"multirate:under", "multirate:super", "undersample", "supersample"}) {
    EXPECT_THROW(check_tile_sampling(kernels::parse_program(name)), sim::InputError) << name;
  }
}

}  // namespace
}  // namespace tools

namespace test {
namespace {

TEST(SampledRun, ReportsEstimatesAndIntervals) {
  const TempFolder folder;
  const Words sampled = {"run",   "--resolution",  "160x160", "--threads", "1",
                         "--set", "render.tile=4", "--set",   "cores=2",   "--tile-sampling",
                         "5%",    "--image",       "none",    "-o",        (folder.path() / "out").string()};
  const ProcessResult ending = raywatt(sampled);
  ASSERT_EQ(ending.exit, 0) << ending.err;
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "out" / "image.png"));
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "out" / "image.exr"));
  EXPECT_EQ(ending.out.find("image.png"), std::string::npos);
  EXPECT_SAYS(ending.out, "of 1600 tiles simulated");
  EXPECT_SAYS(ending.out, "±");
  const nlohmann::json totals = read_json(folder.path() / "out" / "report.json")["totals"];
  const nlohmann::json& s = totals["sampled"];
  for (const char* figure : {"cycles", "time_ms", "energy_mj"}) {
    EXPECT_LT(s[figure]["low"], s[figure]["estimate"]) << figure;
    EXPECT_LT(s[figure]["estimate"], s[figure]["high"]) << figure;
  }
  const nlohmann::json report = read_json(folder.path() / "out" / "report.json");
  const nlohmann::json& bytes = report["sampled_counters"]["dram.channel.counters.bytes"];
  EXPECT_EQ(bytes["estimate"], totals["dram_bytes"]);
  EXPECT_LT(bytes["low"], bytes["estimate"]);
  const nlohmann::json& standby = report["sampled_counters"]["dram.channel.counters.active_standby"];
  EXPECT_LT(standby["low"], standby["estimate"]) << "what time alone brings is in the blocks, too";
  EXPECT_EQ(s["cycles"]["estimate"], totals["cycles"]);
  EXPECT_EQ(s["time_ms"]["estimate"], totals["time_ms"]);
  EXPECT_EQ(s["energy_mj"]["estimate"], totals["energy_mj"]["nominal"]);
  double blocks = 0;
  for (const auto& [name, energy] : totals["energy_by_block_mj"].items()) blocks += energy["nominal"].get<double>();
  EXPECT_NEAR(blocks, totals["energy_mj"]["nominal"], 1e-9);
}

TEST(SampledRun, WhatMakesNoSenseIsRefusedBeforeAnythingIsMade) {
  expect_refused_run({"--tile-sampling", "lots"}, {"e.g. 5%"});
  expect_refused_run({"--tile-sampling", ""}, {"allowed: 5%, auto"});
  expect_refused_run({"--tile-sampling", "5%", "--program", "undersample"}, {"full:N"});
  expect_refused_run({"--tile-sampling", "5%", "--reference", "full:1"}, {"--reference"});
  expect_refused_run({"--tile-sampling", "5%", "--debug-images"}, {"--tile-sampling does not go with --debug-images"});
  expect_refused_run({"--image", "none"}, {"--tile-sampling"});
}

}  // namespace
}  // namespace test
