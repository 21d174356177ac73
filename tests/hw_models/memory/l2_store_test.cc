#include <gtest/gtest.h>

#include "hw_models/memory/l2_bank.h"

namespace hw {
namespace {

/// Returns a store of four sets of one line each, so that slot n has line n.
L2Config four_lines() {
  L2Config c;
  c.banks = 1;
  c.cache.size = {256};
  c.cache.ways = 1;
  return c;
}

TEST(L2Store, IsCleanedInTheOrderOfItsSlotsWithWrapAround) {
  L2Store store(four_lines());
  for (const Addr line : {192U, 64U, 0U}) store.allocate(line, kWholeLine, 0b1);
  EXPECT_EQ(store.dirty_lines(), 3U);
  EXPECT_EQ(store.clean_next_dirty_line().line, 0U);
  EXPECT_EQ(store.clean_next_dirty_line().line, 64U);
  store.write_sectors(0, 0b1000);
  EXPECT_EQ(store.clean_next_dirty_line().line, 192U);
  const L2Store::Victim last = store.clean_next_dirty_line();
  EXPECT_EQ(last.line, 0U);
  EXPECT_EQ(last.sectors, 0b1000U);
  EXPECT_EQ(store.dirty_lines(), 0U);
}

TEST(L2Store, DistinguishesPartialFromWholeLines) {
  L2Store store(four_lines());
  EXPECT_EQ(store.look_up(64, 0b1), L2Store::LookupResult::kNot);
  store.allocate(64, 0b0011, 0b0001);
  EXPECT_EQ(store.look_up(64, 0b0011), L2Store::LookupResult::kAll);
  EXPECT_EQ(store.look_up(64, 0b0110), L2Store::LookupResult::kPart);
  EXPECT_EQ(store.write_sectors(64, 0b0101), 0b0001U) << "dirty before";
  EXPECT_EQ(store.look_up(64, 0b0111), L2Store::LookupResult::kAll);
  EXPECT_EQ(store.invalidate_line(64), 0b0101U) << "what is dirty";
  EXPECT_EQ(store.look_up(64, 0b1), L2Store::LookupResult::kNot);
}

TEST(L2Store, ReturnsOnlyTheDirtySectorsOfAVictim) {
  L2Store store(four_lines());
  store.allocate(64, kWholeLine, 0b1010);
  const L2Store::Victim victim = store.allocate(64 + 256, kWholeLine, 0);
  EXPECT_EQ(victim.line, 64U);
  EXPECT_EQ(victim.sectors, 0b1010U);
  EXPECT_EQ(store.dirty_lines(), 0U);
  EXPECT_EQ(store.allocate(64, kWholeLine, 0).sectors, 0U) << "it was clean";
}

}  // namespace
}  // namespace hw
