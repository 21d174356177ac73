#include "hw_models/dram/dram_measurements.h"

#include <gtest/gtest.h>

#include "sim/config/config.h"

namespace hw::test {
namespace {

class DramMeasurements : public testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Grades, DramMeasurements,
                         testing::Values("lpddr3-1600", "lpddr4-3200", "lpddr4-4266", "lpddr4x-4266", "lpddr5-6400"),
                         [](const auto& grade) {
                           std::string name = grade.param;
                           std::erase(name, '-');
                           return name;
                         });

void expect_good(const DramConfig& grade) {
  for (const DramMeasurement& f : dram_measurements(grade)) {
    EXPECT_TRUE(f.good()) << f.name << ": " << f.measured << " " << f.unit << ", expected " << f.expected;
  }
}

DramConfig load(const std::string& grade) { return sim::load_config<DramConfig>("configs/dram/" + grade + ".yaml"); }

TEST_P(DramMeasurements, AllHoldToTheirClosedForms) { expect_good(load(GetParam())); }

TEST(DramMeasurement, OfCommandsOfTwoBurstsHoldsToItsClosedForm) {
  DramConfig grade = load("lpddr5-6400");
  grade.organisation.bl32 = true;
  expect_good(grade);
}

TEST(DramMeasurement, OfRefreshesThatLeaveNoTimeIsLeftOut) {
  DramConfig grade = load("lpddr4-3200");
  const std::size_t all = dram_measurements(grade).size();
  grade.timing.rfc_ab = 8192;
  EXPECT_EQ(dram_measurements(grade).size(), all - 1);
}

}  // namespace
}  // namespace hw::test
