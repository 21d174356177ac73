#include "tools/limiter.h"

#include <algorithm>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tools/run_job.h"

// The words for what holds a frame back, on made-up units of 100 cycles each.

namespace test {
namespace {

using Why = std::vector<std::pair<std::string, std::uint64_t>>;

sim::UnitReport unit_of(std::string path, const Why& why) {
  sim::UnitReport report;
  report.path = std::move(path);
  report.elapsed = 100;
  report.why = why;
  return report;
}

/// A machine of one core; what is not given is idle.
struct Machine {
  Why trv = {{"starved", 100}};
  Why ist = {{"starved", 100}};
  Why srp = {{"starved", 100}};
  Why dram = {{"idle", 100}};
  std::vector<sim::UnitReport> units() const {
    return {unit_of("core0.tni.trv0", trv), unit_of("core0.tni.ist", ist), unit_of("core0.srp", srp),
            unit_of("dram.channel0", dram)};
  }
  std::string words() const { return tools::limiter(units()); }
};

TEST(Limiter, IsTheBusiestKindOfUnitAndWhatItLosesMostTimeTo) {
  Machine machine{.trv = {{"visiting", 60}, {"l1_miss", 25}, {"ist", 15}}, .srp = {{"running", 40}, {"waiting", 60}}};
  EXPECT_EQ(machine.words(),
            "traversal units, busy 60 % of the time; they lose most to node lines that are not in their caches (25 %)");
  machine.dram = {{"reading", 60}, {"writing", 25}, {"turnaround", 15}};
  EXPECT_EQ(machine.words(),
            "memory channels, busy 85 % of the time; they lose most to changes between reads and writes (15 %)");
}

TEST(Limiter, LosesNothingIfItIsBusyAllTheTime) {
  EXPECT_EQ((Machine{.ist = {{"testing", 100}}}).words(), "intersection units, busy 100 % of the time");
}

TEST(Limiter, ShaderCoresAreBusyWhileTheySwitchKernelsToo) {
  const Machine machine{.trv = {{"visiting", 60}, {"starved", 40}},
                        .srp = {{"running", 45}, {"switching", 20}, {"cache_miss", 35}}};
  EXPECT_EQ(machine.words(),
            "shader cores, busy 65 % of the time; they lose most to misses of their data caches (35 %)");
}

TEST(Limiter, HasWordsForEveryReasonOfTheRealUnits) {
  tools::JobOptions options;
  options.resolution = "16x16";
  const auto units = tools::simulate(tools::load_inputs(options), kernels::parse_program("full:1"), 1).units;
  for (const auto& [kind, busy] :
       {std::pair{".trv", "visiting"}, {".ist", "testing"}, {".srp", "running"}, {"dram.", "reading"}}) {
    const auto of_kind = [&](const sim::UnitReport& unit) { return unit.path.find(kind) != std::string::npos; };
    const auto real = std::ranges::find_if(units, of_kind);
    ASSERT_NE(real, units.end()) << kind;
    for (const auto& [reason, cycles] : real->why) {
      const std::string words = tools::limiter(std::vector{unit_of(real->path, {{busy, 50}, {reason, 50}})});
      const bool told = words.find("busy 100 %") != std::string::npos || words.find("(50 %)") != std::string::npos;
      EXPECT_TRUE(told) << real->path << ", " << reason << ": " << words;
    }
  }
}

TEST(Utilisation, IsTheShareOfCyclesInWhichUnitsOfAKindWork) {
  const Machine machine{.trv = {{"visiting", 30}, {"starved", 70}},
                        .srp = {{"running", 45}, {"switching", 5}, {"starved", 50}},
                        .dram = {{"reading", 20}, {"writing", 5}, {"idle", 75}}};
  const tools::Utilisation used = tools::utilisation(machine.units());
  EXPECT_DOUBLE_EQ(used.tni, 0.30);
  EXPECT_DOUBLE_EQ(used.srp, 0.50);
  EXPECT_DOUBLE_EQ(used.dram, 0.25);
  EXPECT_EQ(tools::utilisation({}).tni, 0);
}

TEST(Utilisation, IsTheMeanOverCores) {
  const std::vector<sim::UnitReport> units = {unit_of("core0.srp", {{"running", 100}}),
                                              unit_of("core1.srp", {{"starved", 100}})};
  EXPECT_DOUBLE_EQ(tools::utilisation(units).srp, 0.5);
}

}  // namespace
}  // namespace test
