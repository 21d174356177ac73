#include "hw_models/srp/op_table.h"

namespace hw {

OpClass class_of(kernels::Op op) {
  using kernels::Op;
  switch (op) {
    case Op::kInput:
    case Op::kConstant:
    case Op::kBits:
    case Op::kCount:
      return OpClass::kFree;
    case Op::kAdd:
    case Op::kSub:
      return OpClass::kFpAdd;
    case Op::kMul:
      return OpClass::kFpMul;
    case Op::kDiv:
    case Op::kSqrt:
      return OpClass::kFpDivSqrt;
    case Op::kMin:
    case Op::kMax:
    case Op::kLess:
    case Op::kLessEqual:
    case Op::kEqual:
      return OpClass::kFpCompare;
    case Op::kIntAdd:
    case Op::kIntSub:
    case Op::kIntLess:
    case Op::kIntEqual:
      return OpClass::kIntAdd;
    case Op::kIntMul:
      return OpClass::kIntMul;
    case Op::kAbs:
    case Op::kNeg:
    case Op::kAnd:
    case Op::kOr:
    case Op::kXor:
    case Op::kSelect:
      return OpClass::kIntLogic;
    case Op::kShiftLeft:
    case Op::kShiftRight:
      return OpClass::kIntShift;
    case Op::kFloor:
    case Op::kToFloat:
    case Op::kToInt:
      return OpClass::kConvert;
    case Op::kLoadLocal:
      return OpClass::kLocalRead;
    case Op::kStoreLocal:
      return OpClass::kLocalWrite;
    case Op::kLoadCached:
      return OpClass::kCachedRead;
  }
  return OpClass::kFree;
}

namespace {

/// The key that holds a class's latency, none if it has no such key; the energy event of one operation.
struct Row {
  std::uint32_t OpLatencyConfig::*latency = nullptr;
  const char* event = "";
};

constexpr std::array<Row, kOpClasses + 1> kRows = [] {
  std::array<Row, kOpClasses + 1> rows{};
  const auto row = [&](OpClass c, std::uint32_t OpLatencyConfig::*latency, const char* event) {
    rows[static_cast<std::size_t>(c)] = {latency, event};
  };
  row(OpClass::kFpAdd, &OpLatencyConfig::fp_add, "srp.fp_add");
  row(OpClass::kFpMul, &OpLatencyConfig::fp_mul, "srp.fp_mul");
  row(OpClass::kFpDivSqrt, &OpLatencyConfig::div_sqrt, "srp.fp_div_sqrt");
  row(OpClass::kFpCompare, &OpLatencyConfig::fp_compare, "srp.fp_compare");
  row(OpClass::kIntAdd, &OpLatencyConfig::integer, "srp.int_add");
  row(OpClass::kIntMul, &OpLatencyConfig::int_mul, "srp.int_mul");
  row(OpClass::kIntLogic, &OpLatencyConfig::integer, "srp.int_logic");
  row(OpClass::kIntShift, &OpLatencyConfig::integer, "srp.int_shift");
  row(OpClass::kConvert, &OpLatencyConfig::convert, "srp.convert");
  row(OpClass::kLocalRead, &OpLatencyConfig::local_load, "tile.read");
  row(OpClass::kLocalWrite, nullptr, "tile.write");
  row(OpClass::kCachedRead, &OpLatencyConfig::cached_load, "");
  return rows;
}();

}  // namespace

std::uint32_t latency_of(OpClass c, const OpLatencyConfig& latency) {
  if (c == OpClass::kLocalWrite) return 1;
  const auto key = kRows[static_cast<std::size_t>(c)].latency;
  return key == nullptr ? 0 : latency.*key;
}

std::uint32_t occupancy_of(OpClass c, const OpLatencyConfig& latency) {
  return c == OpClass::kFpDivSqrt ? latency.div_sqrt_interval : 1;
}

const char* energy_event(OpClass c) { return kRows[static_cast<std::size_t>(c)].event; }

}  // namespace hw
