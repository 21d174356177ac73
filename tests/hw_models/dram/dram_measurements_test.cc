#include "hw_models/dram/dram_measurements.h"

#include <algorithm>

#include <gtest/gtest.h>

#include "sim/config/config.h"

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

}  // namespace
}  // namespace hw::test
