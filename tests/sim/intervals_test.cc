#include "sim/intervals.h"

#include <algorithm>

#include <gtest/gtest.h>

namespace sim::test {
namespace {

/// Records a counter of femtoseconds until `end`, and returns the recorded intervals.
Intervals recorded(Time length, std::size_t most, Time end) {
  Intervals intervals(length, most);
  intervals.allocate_rows(1);
  while (intervals.next_interval_boundary() < end) {
    const Time edge = intervals.next_interval_boundary();
    *intervals.add_next_row() = edge;
  }
  *intervals.add_last_row(end) = end;
  return intervals;
}

TEST(IntervalRows, AreAtMultiplesOfTheirLengthAndAtTheEnd) {
  const Intervals intervals = recorded(10, 8, 34);
  ASSERT_EQ(intervals.size(), 4U);
  for (std::size_t i = 0; i < 3; ++i) EXPECT_EQ(intervals.row(i)[0], 10 * (i + 1));
  EXPECT_EQ(intervals.row(3)[0], 34U);
  EXPECT_EQ(intervals.interval_end(3), 34U);
}

TEST(IntervalRows, HaveNoEmptyOneAtAnEndThatIsAnEdge) {
  EXPECT_EQ(recorded(10, 8, 30).size(), 3U);
  EXPECT_EQ(recorded(10, 8, 10).size(), 1U);
}

TEST(IntervalRows, AreAtMostTheLimitAndAtLeastHalfOfIt) {
  for (const std::size_t most : {2U, 4U, 6U, 64U}) {
    for (Time end = 1; end < 3000; ++end) {
      const Intervals intervals = recorded(10, most, end);
      ASSERT_LE(intervals.size(), most) << end;
      ASSERT_GE(2 * intervals.size(), std::min<std::size_t>(most, end / 10)) << end;
      for (std::size_t i = 0; i < intervals.size(); ++i)
        ASSERT_EQ(intervals.row(i)[0], intervals.interval_end(i)) << end;
      ASSERT_EQ(intervals.interval_end(intervals.size() - 1), end);
    }
  }
}

TEST(IntervalRows, AreFewerIfRowsAreLong) {
  Intervals intervals(10);
  intervals.allocate_rows(Intervals::kMostValues / 4);
  for (int edge = 0; edge < 20; ++edge) intervals.add_next_row();
  EXPECT_LT(intervals.size(), 4U);
}

}  // namespace
}  // namespace sim::test
