#include "sim/link.h"

#include <gtest/gtest.h>

namespace sim::test {
namespace {

constexpr Clock kFast(2), kSlow(3);

TEST(Link, AnItemCanBePoppedItsLatencyLater) {
  Link<int> link(4, 5, kFast);
  link.push(10, 42);
  EXPECT_EQ(link.pop_at(), 20U);
  EXPECT_FALSE(link.can_pop(18));
  ASSERT_TRUE(link.can_pop(20));
  EXPECT_EQ(link.front(), 42);
  EXPECT_EQ(link.pop(20), 42);
  EXPECT_EQ(link.pop_at(), kNever);
}

TEST(Link, HandsItemsOutInTheOrderOfPushes) {
  Link<int> link(3, 1, kFast);
  for (int i = 0; i < 3; ++i) link.push(Time(i) * 2, i);
  for (int i = 0; i < 3; ++i) EXPECT_EQ(link.pop(10), i);
}

TEST(Link, AFullLinkAcceptsAPushAfterAPop) {
  Link<int> link(2, 1, kFast);
  link.push(0, 1);
  EXPECT_EQ(link.push_at(), 0U);
  link.push(0, 2);
  EXPECT_EQ(link.push_at(), kNever);
  EXPECT_FALSE(link.can_push(1'000'000));
  EXPECT_EQ(link.size(), link.capacity());
}

TEST(Link, AFreedSlotIsVisibleTheCycleAfterThePop) {
  Link<int> link(1, 1, kFast);
  link.push(0, 1);
  link.pop(8);
  EXPECT_FALSE(link.can_push(8));
  EXPECT_EQ(link.push_at(), 10U);
  EXPECT_TRUE(link.empty());
}

TEST(Link, CarriesAnItemEveryCycleIfItHoldsOneMoreThanItsLatency) {
  for (const std::size_t capacity : {4U, 3U}) {
    Link<Time> link(capacity, 3, kFast);
    std::uint64_t received = 0;
    for (Time now = 0; now < 2 * 100; now += 2) {
      if (link.can_pop(now)) received += (link.pop(now), 1U);
      if (link.can_push(now)) link.push(now, now);
    }
    EXPECT_EQ(received, capacity == 4 ? 97U : 73U);
  }
}

TEST(Link, IntoAnotherClockDomainWaitsForTheSynchroniserAndTheConsumersEdge) {
  Link<int> link(4, 2, kFast, kSlow, 2);
  link.push(2, 1);
  EXPECT_EQ(link.pop_at(), 12U);  // 2 + 2 x 2 + 2 x 3 = 12, an edge of the consumer
  link.push(4, 2);
  link.pop(12);
  EXPECT_EQ(link.pop_at(), 15U);  // 14 is not an edge
}

TEST(Link, AFreedSlotIsVisibleOnTheProducersEdge) {
  Link<int> link(1, 1, kFast, kSlow, 0);
  link.push(0, 1);
  link.pop(link.pop_at());
  EXPECT_EQ(link.push_at(), 6U);  // popped at 3, free at 6
  link.push(6, 1);
  link.pop(9);
  EXPECT_EQ(link.push_at(), 12U);
}

TEST(Link, LowersTheWakeUpTimesOfItsEnds) {
  Link<int> link(1, 2, kFast);
  Time producer = kNever, consumer = kNever;
  link.set_wakeup_handles(&producer, &consumer);
  link.push(0, 1);
  EXPECT_EQ(consumer, 4U);
  EXPECT_EQ(producer, kNever);
  consumer = 1;
  link.pop(4);
  EXPECT_EQ(producer, 6U);
  link.push(6, 1);
  EXPECT_EQ(consumer, 1U);
}

TEST(Link, MirrorsItsPopTimeAndLowersTheSoonestForAnItemInAnEmptyLink) {
  Link<int> link(3, 2, kFast);
  link.push(0, 1);
  Time pop_at = 0, soonest = 40;
  link.store_pop_time_in(&pop_at, &soonest);
  EXPECT_EQ(pop_at, 4U);
  EXPECT_EQ(soonest, 4U);
  soonest = kNever;
  link.push(2, 2);
  EXPECT_EQ(soonest, kNever) << "the first item is the one to look for";
  link.pop(4);
  EXPECT_EQ(pop_at, 6U);
  link.pop(6);
  EXPECT_EQ(pop_at, kNever);
  link.push(8, 3);
  EXPECT_EQ(pop_at, 12U);
  EXPECT_EQ(soonest, 12U);
}

TEST(NextTransferTime, IsWhenItemOrRoomChanges) {
  EXPECT_EQ(next_transfer_time(10, 2, 16, 0), 16U);  // the item arrives later
  EXPECT_EQ(next_transfer_time(10, 2, 10, kNever),
            kNever);  // the item is here; the link wakes the unit when there is room
  EXPECT_EQ(next_transfer_time(10, 2, 8, 14), 14U);
  EXPECT_EQ(next_transfer_time(10, 2, 8, 4), 12U);  // item and room are here
}

}  // namespace
}  // namespace sim::test
