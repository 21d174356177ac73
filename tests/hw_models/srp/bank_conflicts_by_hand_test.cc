#include <gtest/gtest.h>

#include "hw_models/srp/schedule.h"
#include "tests/hw_models/srp/graph_builder.h"

namespace hw::test {
namespace {

/// Returns the cycles that four loop items lose to conflicts in four banks. One item starts every second cycle. Each
/// accesses its 16-byte record in cycle 0 and in cycle `second`.
std::uint64_t per_4_items(std::uint32_t second) {
  GraphBuilder g;
  const std::uint32_t item = g.item();
  const std::uint32_t one = g.load(16, item), other = g.load(16, item);
  KernelSchedule schedule;
  schedule.ii = 2;
  schedule.placements = {{one, 0, 0, 0}, {other, 0, second, 1}};
  return bank_conflicts(schedule, g.graph(), 4).stall_cycles(4);
}

TEST(BankConflicts, ItemsInFlightConflictIfTheirRecordsAreInOneBank) {
  EXPECT_EQ(per_4_items(0), 4U) << "the same record";
  EXPECT_EQ(per_4_items(1), 0U) << "never in the same cycle";
  EXPECT_EQ(per_4_items(2), 0U) << "the item before, in the bank beside";
  EXPECT_EQ(per_4_items(4), 0U) << "two items before";
  EXPECT_EQ(per_4_items(7), 0U) << "never in the same cycle";
  EXPECT_EQ(per_4_items(8), 4U) << "four items before, in the same bank";
}

}  // namespace
}  // namespace hw::test
