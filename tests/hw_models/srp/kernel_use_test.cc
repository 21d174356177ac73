#include <gtest/gtest.h>

#include "hw_models/srp/srp_stats.h"

namespace hw {
namespace {

TEST(KernelUse, OfTwoCoresIsTheSumOfBoth) {
  KernelUse sum{1, 20, 3, 400, 50};
  sum += KernelUse{2, 30, 4, 500, 60};
  EXPECT_EQ(sum.launches, 3U);
  EXPECT_EQ(sum.items, 50U);
  EXPECT_EQ(sum.idle, 7U);
  EXPECT_EQ(sum.cycles, 900U);
  EXPECT_EQ(sum.starved, 110U);
}

}  // namespace
}  // namespace hw
