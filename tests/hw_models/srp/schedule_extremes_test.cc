#include <algorithm>

#include <gtest/gtest.h>

#include "hw_models/srp/schedule.h"
#include "shader_kernels/catalogue.h"
#include "tests/hw_models/srp/schedule_checker.h"

// Arrays at the ends of what a configuration may ask for: kernels come near their bounds, and soon.

namespace hw::test {
namespace {

/// Every operation takes as long as it may, and a division keeps its unit all the while.
SrpConfig slow_array(std::uint32_t side, std::uint32_t mul_units, std::uint32_t div_sqrt_units) {
  SrpConfig config;
  config.array.rows = config.array.columns = side;
  config.array.mul_units = mul_units;
  config.array.div_sqrt_units = div_sqrt_units;
  OpLatencyConfig& l = config.latency;
  l.fp_add = l.fp_mul = l.fp_compare = l.div_sqrt = l.div_sqrt_interval = 64;
  l.integer = l.int_mul = l.convert = l.local_load = l.cached_load = 64;
  l.load_queue = 0;
  return config;
}

void expect_near_the_bound(const SrpConfig& config) {
  for (const kernels::KernelInfo& kernel : kernels::catalogue()) {
    const KernelSchedule s = schedule(kernel.graph, config);
    EXPECT_EQ(wrong_with(s, kernel.graph, config), "");
    const std::uint32_t bound = std::max({1U, s.res_mii, s.rec_mii});
    EXPECT_LE(s.ii, bound + bound / 3) << kernel.name;
  }
}

TEST(ScheduleExtremes, DivisionsThatKeepTheirUnitFindRoomAmongOthersOfOneCycle) {
  expect_near_the_bound(slow_array(4, 1, 2));
}

TEST(ScheduleExtremes, ASingleUnitTakesAll) { expect_near_the_bound(slow_array(1, 1, 1)); }

}  // namespace
}  // namespace hw::test
