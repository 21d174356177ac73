#include "tools/analysis/report.h"

#include <cstdint>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

// Parts of totals that not every run has: samples and rates beside the picture, items that idled.

namespace tools {
namespace {

using Json = nlohmann::ordered_json;

/// A run whose DMAs have moved one more line of each kind named in `areas` each way.
Simulation run_with_lines(const std::vector<std::string>& areas) {
  JobOptions options;
  options.resolution = "16x16";
  Simulation run = simulate(load_inputs(options), kernels::parse_program("full:1"), 1);
  for (sim::UnitReport& unit : run.units) {
    for (sim::CounterReport& counter : unit.counters) {
      for (const std::string& area : areas) {
        if (counter.name == area + "_lines_read" || counter.name == area + "_lines_written") counter.value += 1;
      }
    }
  }
  return run;
}

std::uint64_t cores(const Simulation& run) {
  std::uint64_t dmas = 0;
  for (const sim::UnitReport& unit : run.units) dmas += unit.path.ends_with(".dma") ? 1 : 0;
  return dmas;
}

TEST(DramClients, SamplesAndRatesAreToldOnlyIfAnyMoved) {
  const Simulation plain = run_with_lines({});
  const Json without = totals_json({plain})["dram_bytes_by_client"];
  EXPECT_FALSE(without.contains("samples"));
  EXPECT_FALSE(without.contains("rates"));
  const Simulation run = run_with_lines({"picture", "samples", "rates", "spill"});
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
  const auto table = [](const Simulation& run) {
    return report_table({{"partial", false},
                         {"program", "full:1"},
                         {"resolution", {16, 16}},
                         {"scene", {{"name", "cornell"}, {"triangles", 1}}},
                         {"frames", Json::array()},
                         {"totals", totals_json({run})}});
  };
  EXPECT_EQ(table(run_with_lines({})).find("samples"), std::string::npos);
  const std::string told = table(run_with_lines({"samples"}));
  EXPECT_NE(told.find(", samples 512 B)"), std::string::npos) << told;
}

TEST(KernelsReported, IdleItemsAreToldOnlyOfKernelsThatHadAny) {
  Simulation run = run_with_lines({});
  for (const auto& [name, kernel] : totals_json({run})["kernels"].items()) EXPECT_FALSE(kernel.contains("idle"));
  for (hw::KernelUse& use : run.kernel_use) use.idle = use.launches;
  for (const auto& [name, kernel] : totals_json({run})["kernels"].items()) {
    EXPECT_EQ(kernel["idle"], kernel["launches"]) << name;
    EXPECT_LE(kernel["starved"], kernel["cycles"]) << name;
  }
}

}  // namespace
}  // namespace tools
