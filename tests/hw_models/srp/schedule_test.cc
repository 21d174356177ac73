#include "hw_models/srp/schedule.h"

#include <tuple>

#include <gtest/gtest.h>

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

}  // namespace
}  // namespace hw::test
