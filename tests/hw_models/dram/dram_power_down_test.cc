#include <gtest/gtest.h>

#include "hw_models/dram/dram_measurements.h"
#include "tests/hw_models/dram/dram_harness.h"

namespace hw::test {
namespace {

TEST(DramPowerDown, LastsToTheEndOfTheFrameInEveryRank) {
  for (const std::uint32_t ranks : {1U, 2U}) {
    constexpr std::uint64_t kEnd = 10'000;  // cycle in which the answer is taken, which ends the run
    const DramConfig c = with([&](DramConfig& d) {
      d.controller.power_down = true;
      d.organisation.ranks = ranks;
    });
    DramHarness b(c);
    b.requester().pop_every = kEnd;
    b.requester().send(b.row(0, 1));
    const std::uint64_t cycles = b.run();
    EXPECT_EQ(cycles, kEnd + 1);
    const auto read = static_cast<std::uint64_t>(DramClosedForms(c).closed_bank_latency());
    const std::uint64_t down =
        1 + read + c.controller.power_down_after + c.timing.rp_ab;  // after one cycle on the link
    EXPECT_EQ(b.stats().power_down, ranks * (cycles - down));
    EXPECT_EQ(b.stats().power_downs, 0U) << "nothing woke it";
    EXPECT_EQ(b.stats().active_standby, down - 1 - c.timing.rp_ab) << "from the activate to the precharge";
    EXPECT_EQ(b.stats().precharge_standby, ranks * down - b.stats().active_standby);
  }
}

TEST(DramPowerDown, DelaysNoRequestThatArrivesInItsFirstCycle) {
  const DramConfig c = with([](DramConfig& d) { d.controller.power_down = true; });
  const DramClosedForms form(c);
  const auto down =
      static_cast<std::uint64_t>(form.closed_bank_latency()) + c.controller.power_down_after + c.timing.rp_ab;
  for (const std::uint64_t later : {0U, 1U}) {
    Script s(c);
    s.read(0, 1);
    s.read(0, 1, down + later);
    s.go();
    EXPECT_EQ(s.latency(1), later == 0 ? form.closed_bank_latency() : form.latency_after_power_down());
    EXPECT_EQ(s.result.stats.power_downs, later);
    EXPECT_EQ(s.result.stats.power_down, later);
  }
}

}  // namespace
}  // namespace hw::test
