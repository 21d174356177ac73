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

TEST_P(DramMeasurements, AllHoldToTheirClosedForms) {
  const auto grade = sim::load_config<DramConfig>(std::string("configs/dram/") + GetParam() + ".yaml");
  for (const DramMeasurement& f : dram_measurements(grade)) {
    EXPECT_TRUE(f.good()) << f.name << ": " << f.measured << " " << f.unit << ", expected " << f.expected;
  }
}

}  // namespace
}  // namespace hw::test
