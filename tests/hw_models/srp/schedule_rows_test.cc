#include <gtest/gtest.h>

#include "hw_models/srp/schedule_graph.h"
#include "sim/hash.h"

namespace hw::test {
namespace {

BitVector with(std::uint32_t size, std::initializer_list<std::uint32_t> taken) {
  BitVector bits(size);
  for (const std::uint32_t row : taken) bits.set(row, true);
  return bits;
}

TEST(ScheduleRows, AGapMayWrapAroundTheTable) {
  const BitVector rows = with(10, {2, 5});
  EXPECT_EQ(rows_until_gap(rows, 0, 2, 10), 0U);
  EXPECT_EQ(rows_until_gap(rows, 2, 2, 10), 1U);
  EXPECT_EQ(rows_until_gap(rows, 2, 3, 10), 4U) << "rows 6, 7, 8";
  EXPECT_EQ(rows_until_gap(rows, 7, 5, 10), 0U) << "rows 7, 8, 9, 0, 1";
  EXPECT_EQ(rows_until_gap(rows, 7, 6, 10), 9U) << "rows 6 to 1, the next time round";
  EXPECT_EQ(rows_until_gap(rows, 7, 7, 10), 10U) << "none";
}

TEST(ScheduleRows, AnEmptyTableHoldsAnOperationOfItsOwnLength) {
  EXPECT_EQ(rows_until_gap(BitVector(64), 63, 64, 64), 0U);
  EXPECT_EQ(rows_until_gap(BitVector(65), 64, 65, 65), 0U);
}

/// Reference implementation that handles one row at a time.
std::uint32_t gap_by_rows(const std::vector<bool>& taken, std::uint32_t from, std::uint32_t length) {
  const auto size = static_cast<std::uint32_t>(taken.size());
  for (std::uint32_t at = 0; at < size; ++at) {
    std::uint32_t free = 0;
    while (free < length && !taken[(from + at + free) % size]) ++free;
    if (free == length) return at;
  }
  return size;
}

TEST(ScheduleRows, RandomTablesAreSearchedAsRowByRow) {
  std::uint64_t draws = 0;
  const auto random = [&](std::uint64_t below) { return static_cast<std::uint32_t>(sim::hash(7, draws++) % below); };
  for (int table = 0; table < 2000; ++table) {
    const std::uint32_t size = 1 + random(200), taken = random(size + 1);
    BitVector bits(size);
    std::vector<bool> rows(size);
    for (std::uint32_t i = 0; i < taken; ++i) {
      const std::uint32_t row = random(size);
      bits.set(row, true);
      rows[row] = true;
    }
    const std::uint32_t from = random(size), length = 1 + random(std::min(size, 20U));
    ASSERT_EQ(rows_until_gap(bits, from, length, size), gap_by_rows(rows, from, length)) << table;
  }
}

}  // namespace
}  // namespace hw::test
