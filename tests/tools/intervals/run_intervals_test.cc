#include <cmath>
#include <cstdlib>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "hw_models/dram/dram_energy.h"
#include "hw_models/machines/gpu_config.h"
#include "sim/config/config.h"
#include "sim/error.h"
#include "sim/io/file.h"
#include "sim/report/energy.h"
#include "tests/hw_models/machines/random_config.h"
#include "tests/tools/program.h"
#include "tools/intervals/intervals.h"
#include "tools/run/frame/power.h"

// Tests of reading the intervals of finished runs. RAYWATT_INTERVALS sets the number of random machines.

namespace test {
namespace {

namespace fs = std::filesystem;
using tools::RunIntervals;

std::uint64_t machines() {
  const char* wanted = std::getenv("RAYWATT_INTERVALS");
  return wanted == nullptr ? 3 : std::strtoull(wanted, nullptr, 10);
}

/// Expects that energies computed from intervals equal those of the frame's report.
void expect_energy_adds_up(const RunIntervals& run, const nlohmann::json& frame_report,
                           const tools::IntervalFrame& frame) {
  const std::pair<const char*, sim::BandMember> sides[] = {
      {"low", &sim::Band::low}, {"nominal", &sim::Band::nominal}, {"high", &sim::Band::high}};
  const auto device = hw::dram_energy_events(run.config().gpu->dram);
  sim::EnergyFormula energy(run.units(), run.config().energy, device, 0, tools::power_scales(run.config()));
  std::vector<sim::UnitReport> until(run.units().begin(), run.units().end());
  RunIntervals::set_cumulative_values(frame, frame.rows - 1, until);
  energy.set_counts(until, frame.interval_end(frame.rows - 1));
  for (const auto& [name, side] : sides) {
    const std::vector<double> blocks = energy.block_energies(side);
    ASSERT_EQ(blocks.size(), frame_report["energy_by_block_mj"].size());
    for (std::size_t b = 0; b < blocks.size(); ++b) {
      const std::string& block = energy.block_names()[b];
      EXPECT_EQ(blocks[b] * 1e-9, frame_report["energy_by_block_mj"][block][name].get<double>())
          << block << ' ' << name;
    }
    const tools::IntervalTable table = tools::derive_table(run, frame, side);
    const tools::IntervalSeries* power = table.find("power", "total");
    ASSERT_NE(power, nullptr);
    double pj = 0;
    for (std::size_t i = 0; i < power->values.size(); ++i) {
      pj += power->values[i] * (table.end_us[i] - table.begin_us[i]) * 1e6;
    }
    const double stated = frame_report["energy_mj"][name].get<double>() * 1e9;
    EXPECT_NEAR(pj, stated, 1e-9 * stated) << name;
  }
}

void expect_adds_up(const fs::path& folder) {
  const nlohmann::json report = read_json(folder / "report.json");
  const RunIntervals run = RunIntervals::load(folder);  // which compares every counter with the report's
  ASSERT_EQ(run.frames().size(), report["frames"].size());
  for (std::size_t f = 0; f < run.frames().size(); ++f) {
    const tools::IntervalFrame& frame = run.frames()[f];
    EXPECT_EQ(frame.frame, report["frames"][f]["frame"].get<std::uint32_t>());
    EXPECT_EQ(frame.end / run.config().gpu->clocks.tni.clock().period(),
              report["frames"][f]["cycles"].get<std::uint64_t>());
    expect_energy_adds_up(run, report["frames"][f], frame);
  }
}

TEST(RunIntervals, AddUpToTheReportOnRandomMachines) {
  const TempFolder folder;
  for (std::uint64_t seed = 1; seed <= machines(); ++seed) {
    SCOPED_TRACE(seed);
    tools::RunConfig config = tools::load_run_config({});
    *config.gpu = hw::test::random_config(seed);
    const fs::path file = folder.write("machine.yaml", sim::dump_config(config));
    const fs::path out = folder.path() / "out";
    const ProcessResult ended = raywatt(small_run(out, {file.string(), "--scene", "teapot", "--program", "full:4"}));
    ASSERT_EQ(ended.exit, 0) << ended.err;
    expect_adds_up(out);
  }
}

TEST(RunIntervals, OfSeveralFramesAddUpFrameByFrame) {
  const TempFolder folder;
  const fs::path out = folder.path() / "out";
  ASSERT_EQ(raywatt(small_run(out, {"--scene", "chess", "--frames", "0:2"})).exit, 0);
  expect_adds_up(out);
  EXPECT_EQ(RunIntervals::load(out).frames().size(), 3U);
}

TEST(RunIntervals, ChangeNothingElseOfARun) {
  const TempFolder folder;
  const fs::path with = folder.path() / "with", without = folder.path() / "without";
  ASSERT_EQ(raywatt(small_run(with, {"--scene", "chess"})).exit, 0);
  ASSERT_EQ(raywatt(small_run(without, {"--scene", "chess", "--intervals", "off"})).exit, 0);
  nlohmann::json a = read_json(with / "report.json"), b = read_json(without / "report.json");
  for (nlohmann::json* report : {&a, &b}) {
    report->erase("host");
    (*report)["provenance"].erase("argv");
  }
  EXPECT_EQ(a, b);
  for (const char* name : {"image.png", "image.exr", "config.yaml"}) {
    EXPECT_EQ(sim::read_file(with / name, 1 << 24), sim::read_file(without / name, 1 << 24)) << name;
  }
  Words left = names_in(with);
  std::erase(left, tools::kIntervalFile);
  EXPECT_EQ(left, names_in(without));
}

TEST(RunIntervals, AreTheSameForAnyNumberOfThreadsAndOfAReplay) {
  const TempFolder folder;
  const fs::path one = folder.path() / "one", two = folder.path() / "two", again = folder.path() / "again";
  const std::string trace = (folder.path() / "a.trace").string();
  ASSERT_EQ(raywatt(small_run(one, {"--scene", "teapot", "--record", trace})).exit, 0);
  const ProcessResult threaded = raywatt(
      {"run", "--scene", "teapot", "--resolution", "64x32", "--threads", "3", "--replicates", "2", "-o", two.string()});
  ASSERT_EQ(threaded.exit, 0) << threaded.err;
  ASSERT_EQ(raywatt({"trace", "replay", trace, "--quiet", "-o", again.string()}).exit, 0);
  const std::string bytes = sim::read_file(one / tools::kIntervalFile, 1 << 24);
  EXPECT_EQ(bytes, sim::read_file(two / tools::kIntervalFile, 1 << 24));
  EXPECT_EQ(bytes, sim::read_file(again / tools::kIntervalFile, 1 << 24));
  expect_adds_up(again);
}

TEST(RunIntervals, AreNotOfSampledFramesWhichAreEstimates) {
  const TempFolder folder;
  const fs::path out = folder.path() / "out";
  ASSERT_EQ(raywatt(small_run(out, {"--scene", "teapot", "--tile-sampling", "50%"})).exit, 0);
  EXPECT_FALSE(fs::exists(out / tools::kIntervalFile));
  EXPECT_FALSE(RunIntervals::has_intervals(tools::load_report(out)));
  EXPECT_THROW(RunIntervals::load(out), sim::InputError);
}

TEST(RunIntervals, GoWithARunThatTakesTheirPlaceWithoutAny) {
  const TempFolder folder;
  const fs::path out = folder.path() / "out";
  ASSERT_EQ(raywatt(small_run(out)).exit, 0);
  EXPECT_TRUE(fs::exists(out / tools::kIntervalFile));
  ASSERT_EQ(raywatt(small_run(out, {"--intervals", "off"})).exit, 0);
  EXPECT_FALSE(fs::exists(out / tools::kIntervalFile));
}

TEST(RunIntervals, OfAnotherRunAreRefused) {
  const TempFolder folder;
  const fs::path one = folder.path() / "one", two = folder.path() / "two", three = folder.path() / "three";
  ASSERT_EQ(raywatt(small_run(one, {"--scene", "teapot"})).exit, 0);
  ASSERT_EQ(raywatt(small_run(two, {"--scene", "cornell"})).exit, 0);
  ASSERT_EQ(raywatt(small_run(three, {"--scene", "teapot", "--set", "cores=2"})).exit, 0);
  for (const fs::path& other : {two, three}) {
    fs::copy_file(other / tools::kIntervalFile, one / tools::kIntervalFile, fs::copy_options::overwrite_existing);
    EXPECT_THROW(RunIntervals::load(one), sim::InputError);
  }
}

TEST(IntervalSeries, HaveStacksThatFillTheTimeAndSharesWithinTheirBounds) {
  const TempFolder folder;
  const fs::path out = folder.path() / "out";
  ASSERT_EQ(raywatt(small_run(out, {"--scene", "chess"})).exit, 0);
  const RunIntervals run = RunIntervals::load(out);
  const tools::IntervalTable table = tools::derive_table(run, run.frames().front());
  const std::size_t intervals = run.frames().front().rows;
  ASSERT_GT(intervals, 2U);
  for (const char* group : {"stack.tni", "stack.ist", "stack.srp", "stack.dram"}) {
    for (std::size_t i = 0; i < intervals; ++i) {
      double sum = 0;
      for (const tools::IntervalSeries& s : table.series) sum += s.group == group ? s.values[i] : 0;
      EXPECT_NEAR(sum, 100, 1e-9) << group << ' ' << i;
    }
  }
  for (const tools::IntervalSeries& s : table.series) {
    ASSERT_EQ(s.values.size(), intervals) << s.name;
    for (const double value : s.values) {
      if (s.group == "hit_rate" && std::isnan(value)) continue;
      EXPECT_GE(value, 0) << s.group << ' ' << s.name;
      EXPECT_LE(value, s.unit == "%" ? 100 + 1e-9 : 1e9) << s.group << ' ' << s.name;
    }
  }
  EXPECT_EQ(table.find("rays_in_flight", "tni")->values.back(), 0);
}

TEST(IntervalSeries, SayTheFramesBytesOverItsTime) {
  const TempFolder folder;
  const fs::path out = folder.path() / "out";
  ASSERT_EQ(raywatt(small_run(out, {"--scene", "chess"})).exit, 0);
  const RunIntervals run = RunIntervals::load(out);
  for (const std::size_t most : {std::size_t{2048}, std::size_t{5}, std::size_t{1}}) {
    const tools::IntervalTable table = tools::derive_table(run, run.frames().front(), &sim::Band::nominal, most);
    ASSERT_LE(table.end_us.size(), most);
    double bytes = 0, rays = 0;
    for (std::size_t i = 0; i < table.end_us.size(); ++i) {
      const double us = table.end_us[i] - table.begin_us[i];
      bytes += 1e3 * us *
               (table.find("bandwidth", "dram_read")->values[i] + table.find("bandwidth", "dram_write")->values[i]);
      rays += us * table.find("rays", "traced")->values[i];
    }
    const nlohmann::json totals = read_json(out / "report.json")["totals"];
    EXPECT_NEAR(bytes, totals["dram_bytes"].get<double>(), 1e-6 * bytes);
    EXPECT_NEAR(rays, totals["rays"]["total"].get<double>(), 1e-6 * rays);
  }
}

}  // namespace
}  // namespace test
