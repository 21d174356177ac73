#include "tools/analysis/report.h"

#include <algorithm>
#include <cctype>
#include <cstdint>
#include <sstream>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "sim/error.h"
#include "sim/io/json.h"
#include "tests/tools/program.h"
#include "tools/analysis/report_file.h"

// Tests of optional parts of a report's totals: DRAM traffic of samples and rates, idle items, and the printed table.

namespace tools {
namespace {

using sim::Json;

/// Returns a run in which the DMA moved one more line in each direction for each memory area in `areas`.
FrameResult run_with_lines(const std::vector<std::string>& areas) {
  JobOptions options;
  options.resolution = "16x16";
  FrameResult run = simulate_frame(load_inputs(options), kernels::parse_program("full:1"), 1);
  for (sim::UnitReport& unit : run.units) {
    for (sim::CounterReport& counter : unit.counters) {
      for (const std::string& area : areas) {
        if (counter.name == area + "_lines_read" || counter.name == area + "_lines_written") counter.value += 1;
      }
    }
  }
  return run;
}

std::uint64_t cores(const FrameResult& run) {
  std::uint64_t dmas = 0;
  for (const sim::UnitReport& unit : run.units) dmas += unit.path.ends_with(".dma") ? 1 : 0;
  return dmas;
}

TEST(DramClients, SamplesAndRatesAreReportedOnlyIfAnyMoved) {
  const FrameResult plain = run_with_lines({});
  const Json without = totals_json({plain})["dram_bytes_by_client"];
  EXPECT_FALSE(without.contains("samples"));
  EXPECT_FALSE(without.contains("rates"));
  const FrameResult run = run_with_lines({"picture", "samples", "rates", "spill"});
  const Json with = totals_json({run})["dram_bytes_by_client"];
  const std::uint64_t more = 2 * 64 * cores(run);
  EXPECT_GT(more, 0U);
  EXPECT_EQ(with["samples"], more);
  EXPECT_EQ(with["rates"], more);
  EXPECT_EQ(with["spills"], without["spills"].get<std::uint64_t>() + more);
  EXPECT_EQ(with["frame_buffer"], without["frame_buffer"].get<std::uint64_t>() + more);
  EXPECT_EQ(with["caches"], without["caches"]);
}

TEST(DramClients, TheTableNamesThem) {
  const auto table = [](const FrameResult& run) {
    return report_table({{"partial", false},
                         {"program", "full:1"},
                         {"resolution", {16, 16}},
                         {"scene", {{"name", "cornell"}, {"triangles", 1}}},
                         {"frames", Json::array()},
                         {"totals", totals_json({run})}});
  };
  EXPECT_EQ(table(run_with_lines({})).find("samples"), std::string::npos);
  const std::string printed = table(run_with_lines({"samples"}));
  EXPECT_NE(printed.find(", samples 512 B)"), std::string::npos) << printed;
}

TEST(KernelsReported, IdleItemsAreReportedOnlyForKernelsWithAny) {
  FrameResult run = run_with_lines({});
  const Json without = totals_json({run});
  for (const auto& [name, kernel] : without["kernels"].items()) EXPECT_FALSE(kernel.contains("idle")) << name;
  for (hw::KernelUse& use : run.kernel_use) use.idle = use.launches;
  const Json with = totals_json({run});
  EXPECT_FALSE(with["kernels"].empty());
  for (const auto& [name, kernel] : with["kernels"].items()) {
    EXPECT_EQ(kernel["idle"], kernel["launches"]) << name;
    EXPECT_LE(kernel["starved"].get<double>(), kernel["cycles"].get<double>()) << name;
  }
}

/// Returns the digits of the longest number before the share in a line, without leading zeros.
std::ptrdiff_t most_digits(std::string line) {
  line.erase(line.rfind(' ', line.rfind(' ') - 1));
  std::ptrdiff_t most = 0;
  std::istringstream cells(line);
  for (std::string cell; cells >> cell;) {
    if (cell.find_first_not_of("0123456789.") != std::string::npos) continue;
    cell.erase(0, cell.find_first_not_of("0."));
    most = std::max(most, std::ranges::count_if(cell, [](unsigned char c) { return std::isdigit(c) != 0; }));
  }
  return most;
}

TEST(ReportTable, HasEnergiesOfFourDigitsAtMost) {
  const test::TempFolder folder;
  ASSERT_EQ(test::raywatt(test::small_run(folder.path() / "out")).exit, 0);
  Json report = sim::parse_json(test::read_bytes(folder.path() / "out" / "report.json"));
  for (const char* group : {"energy_by_block_mj", "energy_by_kind_mj"}) {
    for (Json& band : report["totals"][group]) {
      for (Json& side : band) side = 1e5 * side.get<double>() + 12.3456789;
    }
  }
  std::istringstream lines(report_table(report));
  std::size_t rows = 0;
  for (std::string line; std::getline(lines, line);) {
    if (!line.ends_with(" %") || line.starts_with(" ")) continue;
    EXPECT_LE(most_digits(line), 4) << line;
    EXPECT_GE(most_digits(line), 3) << line;
    ++rows;
  }
  EXPECT_GT(rows, 10U);
}

TEST(ReportFile, OfTooManyKeysIsRefused) {
  std::string text = "{\"schema\":\"raywatt-report/1\"";
  for (std::size_t i = 0; i < sim::kMostJsonKeys; ++i) text += fmt::format(",\"{}\":0", i);
  try {
    parse_report(text + "}", "report.json");
    FAIL() << "is not refused";
  } catch (const sim::InputError& error) {
    EXPECT_STREQ(error.what(), "report.json: has an object of too many keys; allowed: 250000 keys");
  }
}

}  // namespace
}  // namespace tools
