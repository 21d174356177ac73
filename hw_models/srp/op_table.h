#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "hw_models/srp/srp_config.h"
#include "shader_kernels/graph.h"

namespace hw {

/// Class of an operation: the unit or port of the array that it occupies, which sets its cost.
enum class OpClass : std::uint8_t {
  kFree,  ///< no unit: a value of the loop, a field of a loaded record, reinterpreted bits
  kFpAdd,
  kFpMul,
  kFpMulAdd,  ///< a multiply-add, on arrays with such units
  kFpDivSqrt,
  kFpCompare,  ///< also minimum and maximum
  kIntAdd,     ///< also integer comparisons, which are subtractions
  kIntMul,
  kIntLogic,  ///< also sign changes, selects and combined masks
  kIntShift,
  kConvert,  ///< also floor
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

/// Returns the cycles from issue to the first use of the result.
std::uint32_t latency_of(OpClass c, const OpLatencyConfig& latency);
/// Returns the cycles for which the operation occupies its unit or port.
std::uint32_t occupancy_of(OpClass c, const OpLatencyConfig& latency);

/// Returns the energy event of one operation of this class (local memory: of one 16-byte access). Empty if there is
/// none; the data cache counts its own.
const char* energy_event(OpClass c);

}  // namespace hw
