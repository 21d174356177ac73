#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "hw_models/srp/srp_config.h"
#include "shader_kernels/graph.h"

namespace hw {

/// Class of a kernel operation: the kind of unit or port that the operation occupies in the shader core's array. The
/// class determines latency and energy.
enum class OpClass : std::uint8_t {
  kFree,  ///< operations that occupy no unit: loop variables, fields of loaded records, reinterpreted bits
  kFpAdd,
  kFpMul,
  kFpMulAdd,  ///< multiply-adds, on arrays with multiply-add units
  kFpDivSqrt,
  kFpCompare,  ///< comparisons, minimum and maximum of floats
  kIntAdd,     ///< integer additions, and comparisons, which are subtractions
  kIntMul,
  kIntLogic,  ///< logic operations, sign changes, selects and combined masks
  kIntShift,
  kConvert,  ///< conversions between float and integer, and floor
  kLocalRead,
  kLocalWrite,
  kCachedRead,
  kCount
};
inline constexpr std::size_t kOpClasses = static_cast<std::size_t>(OpClass::kCount);
/// Number of operations of each OpClass. For memory classes, number of 16-byte accesses.
using OpMix = std::array<std::uint32_t, kOpClasses>;

constexpr std::array<std::string_view, kOpClasses> names_of(OpClass) {
  return {"free",    "fp_add",    "fp_mul",    "fp_mul_add", "fp_div_sqrt", "fp_compare",  "int_add",
          "int_mul", "int_logic", "int_shift", "convert",    "local_read",  "local_write", "cached_read"};
}

OpClass op_class_of(kernels::Op op);

constexpr bool is_memory_class(OpClass op_class) {
  return op_class == OpClass::kLocalRead || op_class == OpClass::kLocalWrite || op_class == OpClass::kCachedRead;
}

/// Returns the latency of a class of kernel operations: cycles from an operation's issue to the first use of its
/// result.
std::uint32_t latency_of(OpClass op_class, const OpLatencyConfig& latency);
/// Returns the cycles for which a kernel operation of this class occupies its functional unit or memory port.
std::uint32_t occupancy_of(OpClass op_class, const OpLatencyConfig& latency);

/// Returns the name of the energy event of an operation of this class (for local memory, of a 16-byte access). Empty
/// for classes without an event; the data cache counts its own events.
const char* energy_event_of(OpClass op_class);

}  // namespace hw
