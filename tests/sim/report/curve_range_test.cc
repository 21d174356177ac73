#include <gtest/gtest.h>

#include "sim/report/table.h"
#include "sim/report/table_checks.h"

// Tests of sizes outside the curves of tables, and of number formats.

namespace sim {
namespace {

UnitReport cache(std::string path, std::uint64_t bytes) {
  UnitReport unit;
  unit.path = std::move(path);
  unit.block = "l2";
  unit.cache_bytes = bytes;
  unit.counters.resize(1);
  unit.counters.front().event = "read";
  return unit;
}

std::vector<std::string> lines_of(std::uint64_t bytes) {
  const std::vector<UnitReport> units = {cache("l2.bank0", bytes), cache("l2.bank1", bytes)};
  const Band any{1, 1, 1};
  return curve_range_warnings(units, {{"read@64KiB", any}, {"read@256KiB", any}},
                              {{"l2@32KiB", any}, {"l2@512KiB", any}});
}

TEST(SizesOutsideCurves, AreNamedOnceAKindWithTheRange) {
  EXPECT_EQ(lines_of(512 << 10), std::vector<std::string>{"energy.events: the array of l2.bank has 512 KiB, outside 64 "
                                                          "KiB to 256 KiB of read, and is extrapolated"});
  EXPECT_EQ(lines_of(16 << 10).size(), 2U) << "energy and area";
}

TEST(SizesOutsideCurves, AreNoneAtTheEndsAndBetweenPoints) {
  for (const std::uint64_t kib : {64U, 100U, 256U}) EXPECT_TRUE(lines_of(kib << 10).empty()) << kib;
}

TEST(SizesOutsideCurves, AreNoneOfEventsWithoutSizes) {
  const std::vector<UnitReport> units = {cache("l2.bank0", 1)};
  EXPECT_TRUE(curve_range_warnings(units, {{"read", {1, 1, 1}}}, {}).empty());
}

TEST(SiText, HasNoPrefixForARatio) {
  EXPECT_EQ(si_text(0.335), "0.335");
  EXPECT_EQ(si_text(-0.0042), "-0.00420");
  EXPECT_EQ(si_text(0.335, "J"), "335 mJ");
}

TEST(FourDigits, RoundToFourSignificantDigits) {
  EXPECT_EQ(four_digit_text(4733.4), "4733");
  EXPECT_EQ(four_digit_text(350), "350.0");
  EXPECT_EQ(four_digit_text(9999.7), "10.00 k");
  EXPECT_EQ(four_digit_text(12824), "12.82 k");
  EXPECT_EQ(four_digit_text(-1.23456e7), "-12.35 M");
  EXPECT_EQ(four_digit_text(0.12034), "0.1203");
  EXPECT_EQ(four_digit_text(8.4612e-5), "8.461e-05");
  EXPECT_EQ(four_digit_text(0), "0");
}

}  // namespace
}  // namespace sim
