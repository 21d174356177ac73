#include <algorithm>
#include <ctime>

#include <gtest/gtest.h>

#include "hw_models/srp/schedule.h"
#include "shader_kernels/catalogue.h"
#include "tests/hw_models/srp/schedule_checker.h"

// Tests of arrays at the limits of the configuration: schedules are close to their bounds and found quickly.

namespace hw::test {
namespace {

/// Returns an array on which every operation has its longest latency, and a division occupies its unit for all of it.
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

/// The only kernel whose initiation interval exceeds its lower bound by more than a third: 135 cycles instead of 99.
constexpr std::string_view kFarFromBound = "test_shadow_coloured";
constexpr std::uint32_t kIntervalFarFromBound = 135;

void expect_near_the_bound(const SrpConfig& config) {
  for (const kernels::KernelInfo& kernel : kernels::kernel_catalogue()) {
    const KernelSchedule s = schedule_kernel(kernel.graph, config);
    EXPECT_EQ(first_schedule_error(s, kernel.graph, config), "");
    const std::uint32_t bound = std::max({1U, s.res_mii, s.rec_mii});
    if (kernel.name == kFarFromBound && s.ii > bound + bound / 3) {
      EXPECT_EQ(s.ii, kIntervalFarFromBound) << "a known gap of the scheduler";
    } else {
      EXPECT_LE(s.ii, bound + bound / 3) << kernel.name;
    }
  }
}

TEST(ScheduleExtremes, DivisionsThatKeepTheirUnitFindRoomAmongOthersOfOneCycle) {
  expect_near_the_bound(slow_array(4, 1, 2));
}

/// Returns the processor time in seconds, which a busy host affects less than wall-clock time.
double processor_seconds() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

TEST(ScheduleExtremes, AreFoundInATenthOfASecondOnAQuietHost) {
  SrpConfig config = slow_array(5, 1, 12);
  config.array.local_ports = 1;
  config.array.cache_ports = 4;
  config.latency.fp_add = config.latency.integer = 1;
  for (const kernels::KernelInfo& kernel : kernels::kernel_catalogue()) {
    const double begin = processor_seconds();
    schedule_kernel(kernel.graph, config);
    EXPECT_LT(processor_seconds() - begin, 1)
        << kernel.name;  // ten times the usual time, for slow hosts and builds with assertions
  }
}

TEST(ScheduleExtremes, ASingleUnitTakesAll) { expect_near_the_bound(slow_array(1, 1, 1)); }

}  // namespace
}  // namespace hw::test
