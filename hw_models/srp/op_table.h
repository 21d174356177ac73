#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "hw_models/srp/srp_config.h"
#include "shader_kernels/graph.h"

namespace hw {

/// Class of an operation: the unit or port of the array that it takes, and so what it costs.
enum class OpClass : std::uint8_t {
  kFree,  ///< nothing: a value of the loop, a field of a loaded record, reinterpreted bits
  kFpAdd,
  kFpMul,
  kFpMulAdd,  ///< a product and its addition, of arrays that have such units
  kFpDivSqrt,
  kFpCompare,  ///< minimum and maximum too
  kIntAdd,     ///< a comparison of integers is a subtraction
  kIntMul,
  kIntLogic,  ///< sign changes, selects and combined masks too
  kIntShift,
  kConvert,  ///< floor too
  kLocalRead,
  kLocalWrite,
  kCachedRead,
  kCount
};
inline constexpr std::size_t kOpClasses = static_cast<std::size_t>(OpClass::kCount);
/// Operations, or 16-byte accesses, by class.
using OpMix = std::array<std::uint32_t, kOpClasses>;

constexpr std::array<std::string_view, kOpClasses> names_of(OpClass) {
  return {"free",    "fp_add",    "fp_mul",    "fp_mul_add", "fp_div_sqrt", "fp_compare",  "int_add",
          "int_mul", "int_logic", "int_shift", "convert",    "local_read",  "local_write", "cached_read"};
}

OpClass class_of(kernels::Op op);

constexpr bool is_memory(OpClass c) {
  return c == OpClass::kLocalRead || c == OpClass::kLocalWrite || c == OpClass::kCachedRead;
}

/// Cycles from issue to the first use of the result.
std::uint32_t latency_of(OpClass c, const OpLatencyConfig& latency);
/// Cycles for which the unit or port takes nothing else.
std::uint32_t occupancy_of(OpClass c, const OpLatencyConfig& latency);

/// The energy event of one operation of this class or, for local memory, one 16-byte access; empty if it has none
/// (the data cache counts its own).
const char* energy_event(OpClass c);
inline const char* op_energy_event(kernels::Op op) { return energy_event(class_of(op)); }

}  // namespace hw
