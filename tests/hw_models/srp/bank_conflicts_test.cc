#include <gtest/gtest.h>

#include "hw_models/srp/schedule.h"
#include "shader_kernels/catalogue.h"
#include "tests/hw_models/srp/graph_builder.h"
#include "tests/hw_models/srp/srp_harness.h"

namespace hw {
namespace {

using kernels::Op;
using test::GraphBuilder;
using test::SrpHarness;
using test::TileBuilder;

/// Returns the cycles that 16 loop items lose to bank conflicts, with four ports.
std::uint64_t per_16_items(const GraphBuilder& g, std::uint32_t banks) {
  return bank_conflicts(schedule_kernel(g.graph(), SrpConfig{}), g.graph(), banks).stall_cycles(16);
}

TEST(BankConflicts, ASingleAccessHasNoConflict) {
  GraphBuilder g;
  g.load(16, g.item());
  for (const std::uint32_t banks : {1U, 2U, 16U}) EXPECT_EQ(per_16_items(g, banks), 0U) << banks;
}

TEST(BankConflicts, TwoAccessesOfACycleToOneAddressConflictForAnyNumberOfBanks) {
  GraphBuilder g;
  const std::uint32_t item = g.item();
  g.load(16, item);
  g.load(16, item);
  for (const std::uint32_t banks : {1U, 2U, 16U}) EXPECT_EQ(per_16_items(g, banks), 16U) << banks;
}

TEST(BankConflicts, StaggeredArraysConflictAtEqualIndicesOnlyInASingleBank) {
  GraphBuilder g;
  const std::uint32_t item = g.item();
  g.load(16, item, Op::kLoadLocal, "a");
  g.load(16, item, Op::kLoadLocal, "b");
  EXPECT_EQ(per_16_items(g, 1), 16U);
  EXPECT_EQ(per_16_items(g, 2), 0U);
}

TEST(BankConflicts, TheFourPartsOfARecordNeedFourBanks) {
  GraphBuilder g;
  g.load(64, g.item());
  EXPECT_EQ(per_16_items(g, 4), 0U);
  EXPECT_EQ(per_16_items(g, 2), 16U) << "two parts to a bank";
  EXPECT_EQ(per_16_items(g, 1), 3 * 16U);
}

TEST(BankConflicts, RecordsOfDifferentLengthConflictEveryFewItems) {
  // Array a advances by one bank per item, b (which begins at bank 1) by two. With four banks they share one when i = 1
  // + 2 i or i = 2 + 2 i (mod 4), which is every other item.
  GraphBuilder g;
  const std::uint32_t item = g.item();
  g.load(16, item, Op::kLoadLocal, "a");
  g.load(32, item, Op::kLoadLocal, "b");
  EXPECT_EQ(per_16_items(g, 4), 8U);
}

TEST(BankConflicts, AConstantIndexStaysInItsBank) {
  // The constant's record is in bank 0; the other array begins at bank 1.
  GraphBuilder g;
  g.load(16, g.constant(), Op::kLoadLocal, "table");
  g.load(16, g.item(), Op::kLoadLocal, "stream");
  EXPECT_EQ(per_16_items(g, 8), 2U);
}

TEST(BankConflicts, MoreBanksNeverMakeAKernelOfTheCatalogueSlower) {
  for (const kernels::KernelInfo& kernel : kernels::kernel_catalogue()) {
    const KernelSchedule s = schedule_kernel(kernel.graph, SrpConfig{});
    std::uint64_t before = bank_conflicts(s, kernel.graph, 1).stall_cycles(64);
    for (const std::uint32_t banks : {2U, 4U, 8U, 16U, 32U, 64U}) {
      const std::uint64_t now = bank_conflicts(s, kernel.graph, banks).stall_cycles(64);
      EXPECT_LE(now, before) << kernel.name << " with " << banks;
      before = now;
    }
  }
}

TEST(Srp, StallsForBanksWithThatReason) {
  SrpHarness harness({}, {{.ii = 4, .depth = 50, .conflicts = {3, 4}}});
  TileBuilder work;
  work.launch(0, 9);
  harness.add(work.build()).run();
  EXPECT_EQ(harness.spent(Srp::CycleReason::kBanks), 6U) << "three cycles in every four items";
  EXPECT_EQ(harness.cycles(0), SrpHarness::cold(4) + 6 + 50 + 8 * 4);
  EXPECT_EQ(harness.srp().tile_buffer().stats().bank_conflicts, 6U);
}

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
}  // namespace hw
