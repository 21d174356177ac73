#include "hw_models/srp/op_table.h"

#include <string>

#include <gtest/gtest.h>

namespace hw::test {
namespace {

using kernels::Op;

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

}  // namespace
}  // namespace hw::test
