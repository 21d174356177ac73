#include <cstdio>
#include <set>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "hw_models/srp/schedule.h"
#include "shader_kernels/catalogue.h"
#include "tests/hw_models/srp/schedule_checker.h"

namespace hw::test {
namespace {

SrpConfig array_of(std::uint32_t rows, std::uint32_t columns) {
  SrpConfig config;
  config.array.rows = rows;
  config.array.columns = columns;
  config.array.mul_units = rows * columns;
  config.array.div_sqrt_units = rows * columns / 4;
  return config;
}

TEST(KernelSchedules, EachRunsAtItsLowerBoundAndKeepsEveryDependence) {
  fmt::print("{:<24}{:>5}{:>5}{:>5}{:>7}{:>6}{:>5}{:>7}{:>8}{:>8}\n", "kernel", "ii", "res", "rec", "depth", "ops",
             "div", "reads", "writes", "cached");
  for (const kernels::KernelInfo& kernel : kernels::kernel_catalogue()) {
    const KernelSchedule s = schedule_kernel(kernel.graph, SrpConfig{});
    EXPECT_EQ(first_schedule_error(s, kernel.graph, SrpConfig{}), "");
    EXPECT_EQ(s.ii, std::max(s.res_mii, s.rec_mii)) << kernel.name;
    fmt::print("{:<24}{:>5}{:>5}{:>5}{:>7}{:>6}{:>5}{:>7}{:>8}{:>8}\n", s.kernel, s.ii, s.res_mii, s.rec_mii, s.depth,
               s.fu_ops, s.ops[static_cast<std::size_t>(OpClass::kFpDivSqrt)], s.local_reads, s.local_writes,
               s.cached_loads);
  }
}

TEST(KernelSchedules, ABiggerArrayNeverTakesLongerForAnItem) {
  for (const kernels::KernelInfo& kernel : kernels::kernel_catalogue()) {
    std::uint32_t before = ~0U;
    for (const auto& [rows, columns] : {std::pair{1U, 4U}, {4U, 2U}, {4U, 4U}, {8U, 4U}, {8U, 8U}}) {
      const SrpConfig config = array_of(rows, columns);
      const KernelSchedule s = schedule_kernel(kernel.graph, config);
      EXPECT_EQ(first_schedule_error(s, kernel.graph, config), "") << rows << 'x' << columns;
      EXPECT_LE(s.ii, before) << kernel.name << ' ' << rows << 'x' << columns;
      before = s.ii;
    }
  }
}

TEST(KernelSchedules, OddMachinesKeepEveryDependenceToo) {
  for (const kernels::KernelInfo& kernel : kernels::kernel_catalogue()) {
    for (const std::uint32_t interval : {1U, 3U, 16U}) {
      SrpConfig config = array_of(3, 5);
      config.array.mul_units = 2;
      config.array.local_ports = 1;
      config.latency.div_sqrt_interval = interval;
      config.latency.integer = 3;
      const KernelSchedule s = schedule_kernel(kernel.graph, config);
      EXPECT_EQ(first_schedule_error(s, kernel.graph, config), "") << interval;
      EXPECT_GE(s.ii, std::max(s.res_mii, s.rec_mii));
    }
  }
}

TEST(KernelSchedules, TheSameGraphGivesTheSameSchedule) {
  for (const kernels::KernelInfo& kernel : kernels::kernel_catalogue()) {
    const KernelSchedule a = schedule_kernel(kernel.graph, SrpConfig{}), b = schedule_kernel(kernel.graph, SrpConfig{});
    ASSERT_EQ(a.placements.size(), b.placements.size());
    for (std::size_t i = 0; i < a.placements.size(); ++i) {
      EXPECT_EQ(a.placements[i].start, b.placements[i].start);
      EXPECT_EQ(a.placements[i].unit, b.placements[i].unit);
    }
  }
}

}  // namespace
}  // namespace hw::test
