#include <set>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "hw_models/dram/dram_measurements.h"

namespace hw {
namespace {

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

}  // namespace
}  // namespace hw
