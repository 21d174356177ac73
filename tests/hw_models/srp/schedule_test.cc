#include "hw_models/srp/schedule.h"

#include <algorithm>
#include <cstdio>
#include <ctime>
#include <set>
#include <string>
#include <tuple>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "hw_models/srp/op_table.h"
#include "hw_models/srp/schedule_graph.h"
#include "shader_kernels/catalogue.h"
#include "sim/hash.h"
#include "tests/hw_models/srp/graph_builder.h"
#include "tests/hw_models/srp/schedule_checker.h"

namespace hw::test {
namespace {

using kernels::Op;

KernelSchedule checked(const GraphBuilder& g, const SrpConfig& config = {}) {
  KernelSchedule s = schedule_kernel(g.graph(), config);
  EXPECT_EQ(first_schedule_error(s, g.graph(), config), "");
  return s;
}

TEST(Schedule, AKernelWithoutOperationsTakesACycleAnItem) {
  GraphBuilder g;
  g.item();
  const KernelSchedule s = checked(g);
  EXPECT_EQ(s.ii, 1U);
  EXPECT_EQ(s.depth, 0U);
}

TEST(Schedule, ThirtyTwoIndependentAdditionsShareSixteenUnitsInTwoCycles) {
  GraphBuilder g;
  const auto x = g.item();
  for (int i = 0; i < 32; ++i) g.op(Op::kAdd, {x, x});
  const KernelSchedule s = checked(g);
  EXPECT_EQ(s.res_mii, 2U);
  EXPECT_EQ(s.rec_mii, 0U);
  EXPECT_EQ(s.ii, 2U);
  EXPECT_EQ(s.depth, 1U + 2U);  // the second sixteen additions start a cycle later
}

TEST(Schedule, AChainIsAsDeepAsItsLatenciesAndStillTakesAnItemEveryCycle) {
  GraphBuilder g;
  auto x = g.item();
  for (int i = 0; i < 9; ++i) x = g.op(Op::kAdd, {x, x});
  const KernelSchedule s = checked(g);
  EXPECT_EQ(s.ii, 1U);
  EXPECT_EQ(s.depth, 9U * 2U);
}

TEST(Schedule, TheLocalPortsBoundTheInterval) {
  GraphBuilder g;
  const auto item = g.item();
  const auto record = g.load(64, item);
  g.store(item, std::vector<std::uint32_t>(16, g.field(record, 60)));
  const KernelSchedule s = checked(g);  // 4 reads and 4 writes on 4 ports
  EXPECT_EQ(s.local_reads, 4U);
  EXPECT_EQ(s.local_writes, 4U);
  EXPECT_EQ(s.ii, 2U);
  EXPECT_EQ(s.depth, 6U + 1U + 1U);  // the loads have the even cycles
}

TEST(Schedule, ARecordOfOddSizeTakesWholeAccesses) {
  GraphBuilder g;
  const auto item = g.item();
  g.store(item, {g.field(g.load(20, item), 16), item, item});
  const KernelSchedule s = checked(g);
  EXPECT_EQ(s.local_reads, 2U);
  EXPECT_EQ(s.local_writes, 1U);
}

TEST(Schedule, AFieldWaitsForItsOwnAccessOnly) {
  SrpConfig one_port;
  one_port.array.local_ports = 1;
  GraphBuilder g;
  const auto record = g.load(64, g.item());
  g.op(Op::kAdd, {g.field(record, 0), g.field(record, 0)});
  const KernelSchedule s = checked(g, one_port);
  EXPECT_EQ(s.ii, 4U);
  EXPECT_EQ(s.depth, 3U + 6U);  // the addition ends before the fourth access
}

TEST(Schedule, TheCachePortBoundsTheInterval) {
  GraphBuilder g;
  g.load(64, g.item(), Op::kLoadCached);
  g.load(16, g.item(), Op::kLoadCached);
  for (const auto& [ports, width, ii] :
       {std::tuple{1U, 16U, 5U}, {2U, 16U, 3U}, {1U, 32U, 3U}, {1U, 64U, 2U}, {2U, 64U, 1U}}) {
    SrpConfig config;
    config.array.cache_ports = ports;
    config.array.cache_port_width.bytes = width;
    EXPECT_EQ(checked(g, config).ii, ii) << ports << " of " << width;
    EXPECT_EQ(checked(g, config).cached_loads, 2U);
  }
}

TEST(Schedule, AFieldOfACachedRecordWaitsForItsOwnAccessOnly) {
  for (const auto& [width, depth] : {std::tuple{16U, 3U + 4U}, {32U, 4U + 2U}, {64U, 4U + 2U}}) {
    SrpConfig config;
    config.array.cache_port_width.bytes = width;
    config.latency.cached_load = 4;
    config.latency.load_queue = 0;
    GraphBuilder g;
    const auto record = g.load(64, g.item(), Op::kLoadCached);
    g.op(Op::kAdd, {g.field(record, 60), g.field(record, 60)});
    EXPECT_EQ(checked(g, config).depth, depth) << width << ": the last access's record, or the addition";
  }
}

TEST(Schedule, ASumOverItemsWaitsForItsOwnAddition) {
  SrpConfig config;
  config.latency.fp_add = 4;
  GraphBuilder g;
  const auto sum = g.carried();
  g.close(sum, g.op(Op::kAdd, {sum, g.item()}));
  const KernelSchedule s = checked(g, config);
  EXPECT_EQ(s.rec_mii, 4U);
  EXPECT_EQ(s.ii, 4U);
  EXPECT_EQ(s.depth, 4U);
}

TEST(Schedule, ALongerDistanceSharesTheLatencyAmongItems) {
  SrpConfig config;
  config.latency.fp_add = 4;
  config.latency.fp_mul = 3;
  GraphBuilder g;
  const auto before = g.carried(3);
  g.close(before, g.op(Op::kMul, {g.op(Op::kAdd, {before, g.item()}), g.item()}));
  const KernelSchedule s = checked(g, config);
  EXPECT_EQ(s.rec_mii, 3U);  // 7 cycles in 3 items
  EXPECT_EQ(s.ii, 3U);
}

TEST(Schedule, TwoValuesThatFeedEachOtherFormOneRecurrence) {
  GraphBuilder g;
  const auto a = g.carried(), b = g.carried();
  g.close(a, g.op(Op::kAdd, {b, g.item()}));  // 2 cycles
  g.close(b, g.op(Op::kDiv, {a, g.item()}));  // 16 cycles: 18 in two items
  EXPECT_EQ(checked(g).rec_mii, 9U);
}

TEST(Schedule, ReinterpretedBitsCostNothingEvenInsideARecurrence) {
  GraphBuilder g;
  const auto hash = g.carried();
  g.close(hash, g.op(Op::kBits, {g.op(Op::kXor, {g.op(Op::kBits, {hash}), g.item()})}));
  const KernelSchedule s = checked(g);
  EXPECT_EQ(s.rec_mii, 1U);
  EXPECT_EQ(s.fu_ops, 1U);
}

TEST(Schedule, DividersBoundTheInterval) {
  GraphBuilder g;
  const auto x = g.item();
  for (int i = 0; i < 9; ++i) g.op(i % 2 == 0 ? Op::kDiv : Op::kSqrt, {x, x});
  SrpConfig config;
  EXPECT_EQ(checked(g, config).ii, 3U);  // 9 on 4 units
  config.latency.div_sqrt_interval = 5;
  EXPECT_EQ(checked(g, config).ii, 15U);
  config.array.div_sqrt_units = 9;
  EXPECT_EQ(checked(g, config).ii, 5U);
}

TEST(Schedule, MultipliersAndDividersCountAgainstTheUnitsTheyShare) {
  SrpConfig config;
  config.array.mul_units = 4;
  GraphBuilder g;
  const auto x = g.item();
  for (int i = 0; i < 6; ++i) g.op(Op::kMul, {x, x});
  for (int i = 0; i < 6; ++i) g.op(Op::kDiv, {x, x});
  for (int i = 0; i < 20; ++i) g.op(Op::kIntAdd, {x, x});
  EXPECT_EQ(checked(g, config).ii, 3U);  // 12 on the first 4; all 32 on 16 would take 2
}

TEST(Schedule, AnEvictedOperationIsPlacedAgain) {
  SrpConfig config;
  config.array = {.rows = 1, .columns = 2, .mul_units = 1, .div_sqrt_units = 1};
  config.latency.div_sqrt = 4;
  config.latency.div_sqrt_interval = 4;
  GraphBuilder g;
  const auto sum = g.carried();
  const auto quotient = g.op(Op::kDiv, {sum, g.item()});
  g.close(sum, g.op(Op::kMul, {quotient, g.item()}));
  for (int i = 0; i < 5; ++i) g.op(Op::kMul, {g.op(Op::kAdd, {g.item(), g.item()}), g.item()});
  const KernelSchedule s = checked(g, config);
  EXPECT_EQ(s.res_mii, 10U);  // one unit: a divide of 4 and six multiplications
  EXPECT_EQ(s.rec_mii, 6U);
  EXPECT_EQ(s.ii, 10U);
}

TEST(Schedule, CountsWhatCostsEnergy) {
  GraphBuilder g;
  const auto item = g.item();
  const auto record = g.load(16, item);  // 1 operand, 4 words
  const auto x = g.field(record, 0);
  const auto product = g.op(Op::kMul, {x, g.constant()});            // 2 operands, 1 routed
  const auto lit = g.op(Op::kLess, {product, x});                    // 2 operands, both routed
  g.store(item, {g.op(Op::kSelect, {lit, product, g.constant()})});  // 3 operands, 2 routed; then 2 and 1
  const KernelSchedule s = checked(g);
  EXPECT_EQ(s.fu_ops, 3U);
  EXPECT_EQ(s.rf_reads, 1U + 2U + 2U + 3U + 2U);
  EXPECT_EQ(s.rf_writes, 4U + 3U);
  EXPECT_EQ(s.route_hops, 1U + 2U + 2U + 1U);
  EXPECT_EQ(s.config_reads, 16U * s.ii);
  EXPECT_EQ(s.ops[static_cast<std::size_t>(OpClass::kFpMul)], 1U);
  EXPECT_EQ(s.ops[static_cast<std::size_t>(OpClass::kFpCompare)], 1U);
  EXPECT_EQ(s.ops[static_cast<std::size_t>(OpClass::kIntLogic)], 1U);
}

TEST(Schedule, AValueThatDependsOnItselfWithinAnItemIsRefused) {
  GraphBuilder g;
  const auto circle = g.carried(0);
  g.close(circle, g.op(Op::kAdd, {circle, g.item()}));
  EXPECT_THROW(schedule_kernel(g.graph(), SrpConfig{}), std::invalid_argument);
}

// Tests of arrays whose units multiply and add in one operation.

SrpConfig with_mul_add(bool on = true) {
  SrpConfig config;
  config.array.mul_add = on;
  return config;
}

KernelSchedule checked_with_mul_add(const GraphBuilder& g, const SrpConfig& config = with_mul_add()) {
  KernelSchedule s = schedule_kernel(g.graph(), config);
  EXPECT_EQ(first_schedule_error(s, g.graph(), config), "");
  return s;
}

std::uint32_t ops(const KernelSchedule& s, OpClass kind) { return s.ops[static_cast<std::size_t>(kind)]; }

TEST(ScheduleMulAdd, AProductAndItsSumAreOneOperationOfBothLatencies) {
  for (const Op add : {Op::kAdd, Op::kSub}) {
    for (const bool first : {true, false}) {
      GraphBuilder g;
      const auto x = g.item(), product = g.op(Op::kMul, {x, x});
      g.op(add, {first ? product : x, first ? x : product});
      const KernelSchedule s = checked_with_mul_add(g);
      EXPECT_EQ(s.fu_ops, 1U);
      EXPECT_EQ(ops(s, OpClass::kFpMulAdd), 1U);
      EXPECT_EQ(ops(s, OpClass::kFpMul) + ops(s, OpClass::kFpAdd), 0U);
      EXPECT_EQ(s.depth, 2U + 2U);
      EXPECT_EQ(s.rf_reads, 3U) << "two factors and what they are added to";
      EXPECT_EQ(s.rf_writes, 1U);
    }
  }
}

TEST(ScheduleMulAdd, WithoutMultiplyAddUnitsAProductAndItsSumAreTwoOperations) {
  GraphBuilder g;
  const auto x = g.item();
  g.op(Op::kAdd, {g.op(Op::kMul, {x, x}), x});
  const KernelSchedule s = checked_with_mul_add(g, with_mul_add(false));
  EXPECT_EQ(s.fu_ops, 2U);
  EXPECT_EQ(s.rf_reads, 4U);
  EXPECT_EQ(s.rf_writes, 2U);
}

TEST(ScheduleMulAdd, AProductThatSomethingElseUsesStaysAlone) {
  const auto fused = [](auto&& use) {
    GraphBuilder g;
    const auto x = g.item(), product = g.op(Op::kMul, {x, x});
    use(g, g.op(Op::kAdd, {product, x}), product);
    return ops(checked_with_mul_add(g), OpClass::kFpMulAdd);
  };
  EXPECT_EQ(fused([](GraphBuilder&, auto, auto) {}), 1U);
  EXPECT_EQ(fused([](GraphBuilder& g, auto sum, auto product) { g.op(Op::kMin, {sum, product}); }), 0U);
  EXPECT_EQ(fused([](GraphBuilder& g, auto, auto product) { g.store(g.item(), {product}); }), 0U);
  EXPECT_EQ(fused([](GraphBuilder& g, auto, auto product) { g.close(g.carried(), product); }), 0U);
}

TEST(ScheduleMulAdd, OfTwoProductsOneIsPartOfTheirSum) {
  GraphBuilder g;
  const auto x = g.item();
  g.op(Op::kAdd, {g.op(Op::kMul, {x, x}), g.op(Op::kMul, {x, x})});
  const KernelSchedule s = checked_with_mul_add(g);
  EXPECT_EQ(ops(s, OpClass::kFpMulAdd), 1U);
  EXPECT_EQ(ops(s, OpClass::kFpMul), 1U);
  EXPECT_EQ(s.depth, 2U + 2U) << "the other product is there when it is read";
}

TEST(ScheduleMulAdd, TheSquareOfAProductIsNoSumOfTwo) {
  GraphBuilder g;
  const auto x = g.item(), product = g.op(Op::kMul, {x, x});
  g.op(Op::kAdd, {product, product});
  EXPECT_EQ(ops(checked_with_mul_add(g), OpClass::kFpMulAdd), 0U);
}

TEST(ScheduleMulAdd, IntegersAreNotFused) {
  GraphBuilder g;
  const auto x = g.item();
  g.op(Op::kIntAdd, {g.op(Op::kIntMul, {x, x}), x});
  EXPECT_EQ(checked_with_mul_add(g).fu_ops, 2U);
}

TEST(ScheduleMulAdd, ASumOfProductsOverItemsWaitsForItsAdditionAlone) {
  GraphBuilder g;
  const auto sum = g.carried();
  g.close(sum, g.op(Op::kAdd, {g.op(Op::kMul, {g.item(), g.item()}), sum}));
  const KernelSchedule s = checked_with_mul_add(g);
  EXPECT_EQ(s.rec_mii, 2U) << "the sum is read when the product is there";
  EXPECT_EQ(s.ii, 2U);
}

TEST(ScheduleMulAdd, AMultiplyAddNeedsAMultiplier) {
  SrpConfig config = with_mul_add();
  config.array.mul_units = 2;
  GraphBuilder g;
  const auto x = g.item();
  for (int i = 0; i < 6; ++i) g.op(Op::kAdd, {g.op(Op::kMul, {x, x}), x});
  EXPECT_EQ(checked_with_mul_add(g, config).ii, 3U);
}

TEST(ScheduleMulAdd, NoKernelTakesMoreOfAnything) {
  for (const kernels::KernelInfo& kernel : kernels::kernel_catalogue()) {
    const KernelSchedule before = schedule_kernel(kernel.graph, with_mul_add(false)),
                         after = schedule_kernel(kernel.graph, with_mul_add());
    EXPECT_EQ(first_schedule_error(after, kernel.graph, with_mul_add()), "");
    EXPECT_EQ(after.rec_mii, before.rec_mii) << kernel.name;
    EXPECT_LE(after.res_mii, before.res_mii) << kernel.name;
    EXPECT_LE(after.ii, before.ii) << kernel.name;
    EXPECT_EQ(after.fu_ops + ops(after, OpClass::kFpMulAdd), before.fu_ops) << kernel.name;
    EXPECT_EQ(after.rf_reads + ops(after, OpClass::kFpMulAdd), before.rf_reads) << kernel.name;
    EXPECT_EQ(after.rf_writes + ops(after, OpClass::kFpMulAdd), before.rf_writes) << kernel.name;
  }
}

// Tests of arrays at the limits of the configuration: schedules are close to their bounds and found quickly.

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

std::size_t operations_of_load(std::uint32_t bytes, kernels::Op op = kernels::Op::kLoadLocal) {
  GraphBuilder g;
  g.load(bytes, g.item(), op);
  return ScheduleGraph(g.graph(), {}).operations().size();
}

TEST(ScheduleGraph, ALocalLoadIsAnOperationForEverySixteenBytesThatItBegins) {
  EXPECT_EQ(operations_of_load(1), 1U);
  EXPECT_EQ(operations_of_load(16), 1U);
  EXPECT_EQ(operations_of_load(17), 2U);
  EXPECT_EQ(operations_of_load(32), 2U);
  EXPECT_EQ(operations_of_load(33), 3U);
}

TEST(ScheduleGraph, ACachedLoadIsAnOperationForEveryWidthOfThePortThatItBegins) {
  EXPECT_EQ(operations_of_load(4, kernels::Op::kLoadCached), 1U);
  EXPECT_EQ(operations_of_load(64, kernels::Op::kLoadCached), 1U);
  EXPECT_EQ(operations_of_load(65, kernels::Op::kLoadCached), 2U);
}

TEST(OpTable, EveryOperationHasAClassAndEveryClassWithWorkALatency) {
  for (int i = 0; i < static_cast<int>(Op::kCount); ++i) {
    const OpClass kind = op_class_of(static_cast<Op>(i));
    EXPECT_LT(static_cast<std::size_t>(kind), kOpClasses);
    EXPECT_EQ(kind == OpClass::kFree, latency_of(kind, {}) == 0) << i;
  }
}

TEST(OpTable, EveryOperationCostsEnergyExceptFreeAndCachedOnes) {
  for (int i = 0; i < static_cast<int>(Op::kCount); ++i) {
    const auto op = static_cast<Op>(i);
    const bool without = op == Op::kInput || op == Op::kConstant || op == Op::kBits || op == Op::kLoadCached;
    EXPECT_EQ(std::string(energy_event_of(op_class_of(op))).empty(), without) << i;
  }
  EXPECT_STREQ(energy_event_of(op_class_of(Op::kAdd)), "srp.fp_add");
  EXPECT_STREQ(energy_event_of(op_class_of(Op::kSqrt)), "srp.fp_div_sqrt");
  EXPECT_STREQ(energy_event_of(op_class_of(Op::kMin)), "srp.fp_compare");
  EXPECT_STREQ(energy_event_of(op_class_of(Op::kIntLess)), "srp.int_add");
  EXPECT_STREQ(energy_event_of(op_class_of(Op::kSelect)), "srp.int_logic");
  EXPECT_STREQ(energy_event_of(op_class_of(Op::kFloor)), "srp.convert");
}

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
