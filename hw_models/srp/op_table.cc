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

std::uint32_t latency_of(OpClass c, const OpLatencyConfig& latency) {
  switch (c) {
    case OpClass::kFree:
    case OpClass::kCount:
      return 0;
    case OpClass::kFpAdd:
      return latency.fp_add;
    case OpClass::kFpMul:
      return latency.fp_mul;
    case OpClass::kFpDivSqrt:
      return latency.div_sqrt;
    case OpClass::kFpCompare:
      return latency.fp_compare;
    case OpClass::kIntAdd:
    case OpClass::kIntLogic:
    case OpClass::kIntShift:
      return latency.integer;
    case OpClass::kIntMul:
      return latency.int_mul;
    case OpClass::kConvert:
      return latency.convert;
    case OpClass::kLocalRead:
      return latency.local_load;
    case OpClass::kLocalWrite:
      return 1;
    case OpClass::kCachedRead:
      return latency.cached_load;
  }
  return 0;
}

std::uint32_t occupancy_of(OpClass c, const OpLatencyConfig& latency) {
  return c == OpClass::kFpDivSqrt ? latency.div_sqrt_interval : 1;
}

const char* energy_event(OpClass c) {
  switch (c) {
    case OpClass::kFpAdd:
      return "srp.fp_add";
    case OpClass::kFpMul:
      return "srp.fp_mul";
    case OpClass::kFpDivSqrt:
      return "srp.fp_div_sqrt";
    case OpClass::kFpCompare:
      return "srp.fp_compare";
    case OpClass::kIntAdd:
      return "srp.int_add";
    case OpClass::kIntMul:
      return "srp.int_mul";
    case OpClass::kIntLogic:
      return "srp.int_logic";
    case OpClass::kIntShift:
      return "srp.int_shift";
    case OpClass::kConvert:
      return "srp.convert";
    case OpClass::kLocalRead:
      return "tile.read";
    case OpClass::kLocalWrite:
      return "tile.write";
    case OpClass::kFree:
    case OpClass::kCachedRead:
    case OpClass::kCount:
      return "";
  }
  return "";
}

}  // namespace hw
