#include "hw_models/srp/op_table.h"

#include <initializer_list>

namespace hw {
namespace {

using kernels::Op;

struct Table {
  std::array<OpClass, static_cast<std::size_t>(Op::kCount)> class_of{};
  /// Configuration key of the latency of each operation class. Null: the latency is 0, or latency_of() computes it.
  std::array<std::uint32_t OpLatencyConfig::*, kOpClasses> latency{};
  std::array<const char*, kOpClasses> event{};
  std::size_t ops = 0;  ///< number of operations that are assigned to a class

  constexpr void add_class(OpClass op_class, std::initializer_list<Op> operations, std::uint32_t OpLatencyConfig::*key,
                           const char* name) {
    for (const Op op : operations) class_of[static_cast<std::size_t>(op)] = op_class;
    latency[static_cast<std::size_t>(op_class)] = key;
    event[static_cast<std::size_t>(op_class)] = name;
    ops += operations.size();
  }
};

constexpr Table kTable = [] {
  using enum OpClass;
  using Key = OpLatencyConfig;
  Table t;
  t.add_class(kFree, {Op::kInput, Op::kConstant, Op::kBits}, nullptr, "");
  t.add_class(kFpAdd, {Op::kAdd, Op::kSub}, &Key::fp_add, "srp.fp_add");
  t.add_class(kFpMul, {Op::kMul}, &Key::fp_mul, "srp.fp_mul");
  t.add_class(kFpMulAdd, {}, nullptr, "srp.fp_mul_add");
  t.add_class(kFpDivSqrt, {Op::kDiv, Op::kSqrt}, &Key::div_sqrt, "srp.fp_div_sqrt");
  t.add_class(kFpCompare, {Op::kMin, Op::kMax, Op::kLess, Op::kLessEqual, Op::kEqual}, &Key::fp_compare,
              "srp.fp_compare");
  t.add_class(kIntAdd, {Op::kIntAdd, Op::kIntSub, Op::kIntLess, Op::kIntEqual}, &Key::integer, "srp.int_add");
  t.add_class(kIntMul, {Op::kIntMul}, &Key::int_mul, "srp.int_mul");
  t.add_class(kIntLogic, {Op::kAbs, Op::kNeg, Op::kAnd, Op::kOr, Op::kXor, Op::kSelect}, &Key::integer,
              "srp.int_logic");
  t.add_class(kIntShift, {Op::kShiftLeft, Op::kShiftRight}, &Key::integer, "srp.int_shift");
  t.add_class(kConvert, {Op::kFloor, Op::kToFloat, Op::kToInt}, &Key::convert, "srp.convert");
  t.add_class(kLocalRead, {Op::kLoadLocal}, &Key::local_load, "tile.read");
  t.add_class(kLocalWrite, {Op::kStoreLocal}, nullptr, "tile.write");
  t.add_class(kCachedRead, {Op::kLoadCached}, nullptr, "");
  return t;
}();
static_assert(kTable.ops == static_cast<std::size_t>(Op::kCount), "every operation has one class");

}  // namespace

OpClass op_class_of(Op op) { return kTable.class_of[static_cast<std::size_t>(op)]; }

std::uint32_t latency_of(OpClass op_class, const OpLatencyConfig& latency) {
  if (op_class == OpClass::kLocalWrite) return 1;
  if (op_class == OpClass::kCachedRead) return latency.cached_load_latency();
  if (op_class == OpClass::kFpMulAdd) return latency.fp_mul + latency.fp_add;
  const auto key = kTable.latency[static_cast<std::size_t>(op_class)];
  return key == nullptr ? 0 : latency.*key;
}

std::uint32_t occupancy_of(OpClass op_class, const OpLatencyConfig& latency) {
  return op_class == OpClass::kFpDivSqrt ? latency.div_sqrt_interval : 1;
}

const char* energy_event_of(OpClass op_class) { return kTable.event[static_cast<std::size_t>(op_class)]; }

}  // namespace hw
