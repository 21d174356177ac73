#include <gtest/gtest.h>

#include "hw_models/srp/schedule.h"
#include "shader_kernels/catalogue.h"
#include "tests/hw_models/srp/graph_builder.h"
#include "tests/hw_models/srp/schedule_checker.h"

// Tests of arrays whose units multiply and add in one operation.

namespace hw::test {
namespace {

using kernels::Op;

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

}  // namespace
}  // namespace hw::test
