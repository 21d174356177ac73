#include "hw_models/dram/dram_measurements.h"

#include <algorithm>
#include <set>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "sim/config/config.h"
#include "tests/hw_models/dram/dram_harness.h"

namespace hw::test {
namespace {

class DramMeasurements : public testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Grades, DramMeasurements,
                         testing::Values("lpddr3-1600", "lpddr4-3200", "lpddr4-4266", "lpddr4x-4266", "lpddr5-6400",
                                         "lpddr5x-8533", "lpddr6-10667"),
                         [](const auto& grade) {
                           std::string name = grade.param;
                           std::erase(name, '-');
                           return name;
                         });

void expect_good(const DramConfig& grade) {
  for (const DramMeasurement& f : dram_measurements(grade)) {
    EXPECT_TRUE(f.is_within_tolerance()) << f.name << ": " << f.measured << " " << f.unit << ", expected "
                                         << f.expected;
  }
}

DramConfig load(const std::string& grade) { return sim::load_config<DramConfig>("configs/dram/" + grade + ".yaml"); }

TEST_P(DramMeasurements, AllAgreeWithTheirClosedForms) { expect_good(load(GetParam())); }

TEST(DramMeasurement, OfCommandsOfTwoBurstsAgreesWithItsClosedForm) {
  DramConfig grade = load("lpddr5-6400");
  grade.organisation.bl32 = true;
  expect_good(grade);
}

TEST(DramMeasurement, OfTwoRanksIsMadeIfTheirBanksFitAChannel) {
  const auto is_of_ranks = [](const DramMeasurement& m) { return m.name == "read to read, other rank"; };
  DramConfig grade = load("lpddr5-6400");
  ASSERT_EQ(grade.organisation.banks, 16U);
  EXPECT_EQ(std::ranges::count_if(dram_measurements(grade), is_of_ranks), 1);
}

TEST(DramClosedForms, AStreamIsLimitedByTheLongerOfBurstsAndTheirDistance) {
  DramConfig c;
  c.timing.burst = 8;
  c.timing.ccd_l = 10;
  EXPECT_EQ(DramClosedForms(c).cycles_per_streamed_line(), 2 * 10);
  c.timing.ccd_l = 6;
  EXPECT_EQ(DramClosedForms(c).cycles_per_streamed_line(), 2 * 8);
}

TEST(DramClosedForms, LinesOfManyRowsAreLimitedByTheCommandBusIfCommandsAreLong) {
  DramConfig c;
  c.timing.rrd = c.timing.faw = c.timing.rc = c.timing.ras = c.timing.rcd = c.timing.rp = c.timing.rtp = 1;
  c.timing.ca_column = 20;
  EXPECT_EQ(DramClosedForms(c).cycles_per_line_of_row_stream(1), c.timing.ca_activate + 2 * 20 + c.timing.ca_precharge);
  EXPECT_EQ(DramClosedForms(c).cycles_per_line_of_row_stream(2),
            (c.timing.ca_activate + 4 * 20 + c.timing.ca_precharge) / 2.0);
}

TEST(DramClosedForms, LinesOfManyRowsHaveTheActivateWindowsOfAllRanks) {
  DramConfig c;
  c.timing.faw = 400;
  EXPECT_EQ(DramClosedForms(c).cycles_per_line_of_row_stream(1), 100);
  c.organisation.ranks = 2;
  EXPECT_EQ(DramClosedForms(c).cycles_per_line_of_row_stream(1), 50);
}

TEST(DramMeasurement, IsOmittedForRefreshesThatLeaveNoTime) {
  DramConfig grade = load("lpddr4-3200");
  const std::size_t all = dram_measurements(grade).size();
  grade.timing.rfc_ab = 8192;
  EXPECT_EQ(dram_measurements(grade).size(), all - 1);
}

using Holds = DramMeasurement::Agreement;

bool good(double measured, Holds holds) {
  return DramMeasurement{"", "ns", measured, 100, holds}.is_within_tolerance();
}

TEST(DramMeasurement, IsExactToABillionth) {
  EXPECT_TRUE(good(100, Holds::kExactly));
  EXPECT_TRUE(good(100.00000005, Holds::kExactly));
  EXPECT_FALSE(good(100.000001, Holds::kExactly));
  EXPECT_FALSE(good(99.999999, Holds::kExactly));
}

TEST(DramMeasurement, IsCloseWithinTwoPercent) {
  EXPECT_TRUE(good(98, Holds::kClosely));
  EXPECT_TRUE(good(102, Holds::kClosely));
  EXPECT_FALSE(good(97.9, Holds::kClosely));
  EXPECT_FALSE(good(102.1, Holds::kClosely));
}

TEST(DramMeasurement, IsNearFromNineTenths) {
  EXPECT_TRUE(good(90, Holds::kNearly));
  EXPECT_TRUE(good(100, Holds::kNearly));
  EXPECT_FALSE(good(89.9, Holds::kNearly));
  EXPECT_FALSE(good(100.1, Holds::kNearly));
}

TEST(DramMeasurement, IsAtMostABoundAndTwoPercentForEnds) {
  EXPECT_TRUE(good(0, Holds::kAtMost));
  EXPECT_TRUE(good(102, Holds::kAtMost));
  EXPECT_FALSE(good(102.1, Holds::kAtMost));
}

TEST(DramMeasurement, OfEachKindIsMadeOnce) {
  std::set<std::string> names;
  const std::vector<DramMeasurement> all = dram_measurements(DramConfig{});
  for (const DramMeasurement& m : all) names.insert(m.name);
  EXPECT_EQ(names.size(), all.size());
  for (const char* name : {"sequential reads", "sequential reads, as set", "sequential writes",
                           "sequential writes, as set", "read, powered down", "random reads"})
    EXPECT_EQ(names.count(name), 1U) << name;
}

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
