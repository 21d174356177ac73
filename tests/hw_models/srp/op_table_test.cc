#include "hw_models/srp/op_table.h"

#include <string>

#include <gtest/gtest.h>

namespace hw::test {
namespace {

using kernels::Op;

TEST(OpTable, EveryOperationHasAClassAndEveryClassWithWorkALatency) {
  for (int i = 0; i < static_cast<int>(Op::kCount); ++i) {
    const OpClass kind = class_of(static_cast<Op>(i));
    EXPECT_LT(static_cast<std::size_t>(kind), kOpClasses);
    EXPECT_EQ(kind == OpClass::kFree, latency_of(kind, {}) == 0) << i;
  }
}

TEST(OpTable, EveryOperationCostsEnergyExceptFreeAndCachedOnes) {
  for (int i = 0; i < static_cast<int>(Op::kCount); ++i) {
    const auto op = static_cast<Op>(i);
    const bool without = op == Op::kInput || op == Op::kConstant || op == Op::kBits || op == Op::kLoadCached;
    EXPECT_EQ(std::string(op_energy_event(op)).empty(), without) << i;
  }
  EXPECT_STREQ(op_energy_event(Op::kAdd), "srp.fp_add");
  EXPECT_STREQ(op_energy_event(Op::kSqrt), "srp.fp_div_sqrt");
  EXPECT_STREQ(op_energy_event(Op::kMin), "srp.fp_compare");
  EXPECT_STREQ(op_energy_event(Op::kIntLess), "srp.int_add");
  EXPECT_STREQ(op_energy_event(Op::kSelect), "srp.int_logic");
  EXPECT_STREQ(op_energy_event(Op::kFloor), "srp.convert");
}

}  // namespace
}  // namespace hw::test
