#include "sim/time.h"

#include <gtest/gtest.h>

#include "sim/config/field.h"
#include "sim/hash.h"
#include "sim/unit_report.h"

namespace sim::test {
namespace {

TEST(Clock, HasAnEdgeAtEveryMultipleOfItsPeriod) {
  constexpr Clock clock(3);
  EXPECT_EQ(clock.edge_at_or_after(0), 0U);
  EXPECT_EQ(clock.edge_at_or_after(1), 3U);
  EXPECT_EQ(clock.edge_at_or_after(3), 3U);
  EXPECT_TRUE(clock.is_edge(6));
  EXPECT_FALSE(clock.is_edge(7));
  EXPECT_EQ(clock.edge_after(6, 4), 18U);
  EXPECT_EQ(clock.cycles(20), 6U);
}

TEST(Frequency, RoundsItsPeriodToTheNearestFemtosecond) {
  EXPECT_EQ(Frequency{500'000'000}.clock().period(), 2'000'000U);
  EXPECT_EQ(Frequency{1'333'333'333}.clock().period(), 750'000U);
  EXPECT_EQ(Frequency{3'000'000'000}.clock().period(), 333'333U);
}

enum class CycleReason : std::uint8_t { kIdle, kWorking, kBlocked, kCount };

TEST(Activity, ChargesEveryCycleOnce) {
  Activity<CycleReason> a;
  a.spend(0, 2, CycleReason::kWorking, CycleReason::kBlocked);
  a.spend(10, 2, CycleReason::kWorking, CycleReason::kIdle);
  a.finish(20);
  EXPECT_EQ(a.spent(CycleReason::kWorking), 4U);
  EXPECT_EQ(a.spent(CycleReason::kBlocked), 8U);
  EXPECT_EQ(a.spent(CycleReason::kIdle), 8U);
  EXPECT_EQ(a.accounted_until(), 20U);
}

TEST(Activity, TimeBeforeTheFirstTickGoesToTheFirstReason) {
  Activity<CycleReason> a;
  a.spend(6, 2, CycleReason::kWorking, CycleReason::kWorking);
  EXPECT_EQ(a.spent(CycleReason::kIdle), 6U);
}

TEST(Activity, FinishesOnlyOnce) {
  Activity<CycleReason> a;
  a.spend(0, 2, CycleReason::kWorking, CycleReason::kIdle);
  a.finish(4);
  a.finish(4);
  a.finish(2);
  EXPECT_EQ(a.accounted_until(), 4U);
}

TEST(Hash, DependsOnEveryKeyAndOnTheirOrder) {
  EXPECT_EQ(hash(1, 2, 3), hash(1, 2, 3));
  EXPECT_NE(hash(1, 2, 3), hash(1, 3, 2));
  EXPECT_NE(hash(1, 2), hash(1, 2, 0));
}

TEST(UnitFloat, IsSpreadEvenlyBelowOne) {
  double sum = 0;
  for (std::uint64_t i = 0; i < 10'000; ++i) {
    const float f = hash_to_unit_float(hash(i));
    ASSERT_GE(f, 0.0F);
    ASSERT_LT(f, 1.0F);
    sum += f;
  }
  EXPECT_NEAR(sum / 10'000, 0.5, 0.01);
  EXPECT_LT(hash_to_unit_float(~std::uint64_t{0}), 1.0F);
}

}  // namespace
}  // namespace sim::test
