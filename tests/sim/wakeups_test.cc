#include "sim/machine.h"

#include <algorithm>
#include <cstdint>
#include <vector>

#include <gtest/gtest.h>

#include "sim/hash.h"
#include "sim/ring.h"

namespace sim::test {
namespace {

TEST(WakeupTable, TicksExactlyTheDueUnits) {
  constexpr std::size_t kUnits = 19;
  WakeupTable wakeups(kUnits);
  std::vector<Time> expected(kUnits, 0);
  for (int step = 0; step < 200; ++step) {
    Time now = kNever;
    for (const Time time : expected) now = std::min(now, time);
    ASSERT_EQ(wakeups.earliest_time(), now);
    std::vector<std::size_t> due, ticked;
    for (std::size_t i = 0; i < kUnits; ++i) {
      if (expected[i] == now) due.push_back(i);
    }
    wakeups.tick_due(now, [&](std::size_t i) {
      ticked.push_back(i);
      return expected[i] = now + 1 + hash(step, i) % 40;
    });
    ASSERT_EQ(ticked, due);
    const std::size_t other = hash(step) % kUnits;
    wakeups.lower_to(other, now + 3);
    expected[other] = std::min(expected[other], now + 3);
  }
}

TEST(WakeupTable, ReportsDueUnitsAndTheNextTimeOverSeveralGroups) {
  constexpr std::size_t kUnits = 19, kGroups = 3;
  std::vector<Time> times(WakeupTable::round_up_to_groups(kUnits), kNever), earliest(kGroups);
  for (Time now = 1; now < 200; ++now) {
    for (std::size_t i = 0; i < kUnits; ++i) times[i] = now + hash(now, i) % 5;
    std::uint64_t due = 0;
    for (std::size_t i = 0; i < kUnits; ++i) due |= std::uint64_t{times[i] == now} << i;
    ASSERT_EQ(WakeupTable::due_mask(times.data(), kGroups, now), due);
    ASSERT_EQ(WakeupTable::refresh_group_minima(times.data(), earliest), *std::ranges::min_element(times));
    for (std::size_t g = 0; g < kGroups; ++g)
      ASSERT_EQ(earliest[g], *std::min_element(&times[g * WakeupTable::kGroup],
                                               &times[g * WakeupTable::kGroup] + WakeupTable::kGroup));
  }
}

TEST(WakeupTable, ATickMayLowerTheTimeOfItsOwnUnitAndOfOthers) {
  WakeupTable wakeups(12);
  wakeups.tick_due(0, [&](std::size_t i) {
    if (i == 1) wakeups.lower_to(1, 5);
    if (i == 2) wakeups.lower_to(11, 4);
    return i == 11 ? Time{9} : kNever;
  });
  EXPECT_EQ(wakeups[1], 5U);
  EXPECT_EQ(wakeups[11], 9U) << "what was lowered before the tick is what the tick answers";
  EXPECT_EQ(wakeups.earliest_time(), 5U);
}

TEST(Ring, PopsInOrderAndGrows) {
  Ring<int> ring;
  int in = 0, out = 0;
  for (int round = 0; round < 50; ++round) {
    for (int i = 0; i < 7; ++i) ring.push_back(in++);
    for (int i = 0; i < 4; ++i, ++out) {
      ASSERT_EQ(ring.front(), out);
      ring.pop_front();
    }
  }
  EXPECT_EQ(ring.size(), 150U);
}

}  // namespace
}  // namespace sim::test
