#include <algorithm>
#include <cstdint>
#include <limits>

#include <gtest/gtest.h>

#include "hw_models/dram/dram_device.h"
#include "sim/hash.h"
#include "tests/param_name.h"

namespace hw {
namespace {

constexpr std::uint64_t kNobody = std::numeric_limits<std::int64_t>::max();

/// Small numbers, so that many are equal.
BankLanes some(std::uint32_t banks, std::uint64_t seed) {
  BankLanes lanes(banks);
  for (std::uint32_t bank = 0; bank < banks; ++bank) lanes[bank] = sim::hash(seed, bank) % 16;
  return lanes;
}

std::uint32_t first(std::uint32_t banks) { return static_cast<std::uint32_t>((std::uint64_t{1} << banks) - 1); }

/// Expected results, computed bank by bank.
struct OneByOne {
  const BankLanes &a, &b;
  std::uint32_t banks;

  template <class Holds>
  std::uint32_t all_that(Holds&& holds) const {
    std::uint32_t mask = 0;
    for (std::uint32_t bank = 0; bank < banks; ++bank) mask |= std::uint32_t{holds(bank)} << bank;
    return mask;
  }
  template <class Number>
  std::uint64_t least(std::uint32_t of, Number&& number) const {
    std::uint64_t least = kNobody;
    for (std::uint32_t bank = 0; bank < banks; ++bank) {
      if ((of >> bank & 1) != 0) least = std::min(least, number(bank));
    }
    return least;
  }
};

class BankLanesOf : public testing::TestWithParam<std::uint32_t> {};

TEST_P(BankLanesOf, EqualABankByBankReference) {
  const std::uint32_t banks = GetParam();
  for (std::uint64_t seed = 0; seed < 200; ++seed) {
    const BankLanes a = some(banks, seed), b = some(banks, seed + 1000);
    const OneByOne expected{a, b, banks};
    const std::uint64_t most = seed % 16;
    const auto of = static_cast<std::uint32_t>(sim::hash(seed, 77U)) & first(banks);
    const auto larger = [&](std::uint32_t bank) { return std::max(a[bank], b[bank]); };
    EXPECT_EQ(a.banks_with_value_at_most(most) & first(banks),
              expected.all_that([&](std::uint32_t i) { return a[i] <= most; }));
    EXPECT_EQ(a.banks_with_both_at_most(b, most) & first(banks),
              expected.all_that([&](std::uint32_t i) { return larger(i) <= most; }));
    BankLanes raised = a;
    raised.raise_to_at_least(of, most);
    for (std::uint32_t i = 0; i < banks; ++i) {
      EXPECT_EQ(raised[i], (of >> i & 1) != 0 ? std::max(a[i], most) : a[i]);
    }
    EXPECT_EQ(a.min_of(of), expected.least(of, [&](std::uint32_t i) { return a[i]; }));
    EXPECT_EQ(a.min_of_maxima_with(b, of), expected.least(of, larger));
    std::uint64_t any = 0;
    for (std::uint32_t bank = 0; bank < banks; ++bank) any |= (of >> bank & 1) != 0 ? a[bank] : 0;
    EXPECT_EQ(a.bitwise_or_of(of), any);
  }
}

TEST_P(BankLanesOf, AreAllReplaced) {
  BankLanes lanes = some(GetParam(), 3);
  const BankLanes before = lanes;
  lanes.transform_all([](std::uint64_t number) { return 3 * number + 1; });
  for (std::uint32_t bank = 0; bank < GetParam(); ++bank) EXPECT_EQ(lanes[bank], 3 * before[bank] + 1);
}

INSTANTIATE_TEST_SUITE_P(Sizes, BankLanesOf, testing::Values(1U, 2U, 4U, 8U, 16U, 32U), ::test::ParamName());

TEST(BankLanes, HoldWhatTakesAllBitsOfACycle) {
  BankLanes lanes(8);
  lanes[5] = std::uint64_t{1} << 62;
  EXPECT_EQ(lanes.banks_with_value_at_most((std::uint64_t{1} << 62) - 1), 0xdfU);
  EXPECT_EQ(lanes.banks_with_value_at_most(std::uint64_t{1} << 62), 0xffU);
  EXPECT_EQ(lanes.min_of(1U << 5), std::uint64_t{1} << 62);
  EXPECT_EQ(lanes.min_of(0), kNobody);
}

}  // namespace
}  // namespace hw
