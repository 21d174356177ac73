#include <gtest/gtest.h>

#include "hw_models/dram/dram_measurements.h"
#include "tests/hw_models/dram/dram_harness.h"

namespace hw::test {
namespace {

TEST(DramRequests, ARequestArrivesWhenAnEarlierOneIsDoneIfNoMoreMayBeOutstanding) {
  const DramConfig c = DramHarness::quiet();
  std::vector<DramRequest> requests(12);
  for (std::size_t i = 0; i < requests.size(); ++i) requests[i].address = 64 * i;
  for (const std::uint32_t outstanding : {1U, 2U, 3U}) {
    const DramRun play = hw::run_dram_requests(c, requests, outstanding);
    for (std::size_t i = outstanding; i < requests.size(); ++i)
      EXPECT_EQ(play.arrived[i], play.done[i - outstanding]) << i << " with " << outstanding;
    EXPECT_EQ(play.end, play.done.back());
  }
}

TEST(DramRequests, ASingleBankTakesRowAfterRowInTheTimeOfTheClosedForm) {
  DramConfig c = DramHarness::quiet();
  c.organisation.banks = c.organisation.bank_groups = c.organisation.refresh_banks = c.organisation.ranks = 1;
  const auto lines = static_cast<std::uint32_t>(c.organisation.page.bytes / c.line.bytes);
  std::vector<DramRequest> requests(std::size_t{6} * lines);
  for (std::size_t i = 0; i < requests.size(); ++i) requests[i].address = 64 * i;
  const DramRun play = hw::run_dram_requests(c, requests, 32);
  const sim::Time row = play.done[5 * lines - 1] - play.done[4 * lines - 1];
  const double expected = DramClosedForms(c).cycles_per_line_of_row_stream(lines) * lines;
  EXPECT_NEAR(static_cast<double>(row) / static_cast<double>(c.timing.ck.time), expected, 0.01 * expected);
}

TEST(DramRequests, AnyNumberIsDistinguished) {
  const DramConfig c = DramHarness::quiet();
  std::vector<DramRequest> requests((std::size_t{1} << 16) + 100);
  for (std::size_t i = 0; i < requests.size(); ++i) requests[i].address = 64 * (i % 16);
  const DramRun play = hw::run_dram_requests(c, requests, 1);
  for (std::size_t i = 1; i < requests.size(); ++i) ASSERT_GT(play.done[i], play.done[i - 1]) << i;
}

TEST(DramRequests, NoRequestArrivesBeforeItsTime) {
  const DramConfig c = DramHarness::quiet();
  const sim::Time late = 777 * c.timing.ck.time;
  const DramRun play = hw::run_dram_requests(c, std::vector<DramRequest>{{0, false, 0}, {64, false, late}}, 8);
  EXPECT_EQ(play.arrived[0], 0U);
  EXPECT_EQ(play.arrived[1], late);
}

}  // namespace
}  // namespace hw::test
