#pragma once
#include <cstdint>
#include <string>
#include <vector>

namespace kernels {

// clang-format off
/// Operations of the SRP's functional units, and accesses to memory.
enum class Op : std::uint8_t {
  kInput,     ///< a field of a loaded record (free: the load is counted) or a value of the loop (item index)
  kConstant,  ///< a literal or a uniform, held in a register for the whole loop
  kAdd, kSub, kMul, kDiv, kSqrt, kMin, kMax, kAbs, kNeg, kFloor,  // 32-bit float
  kIntAdd, kIntSub, kIntMul, kAnd, kOr, kXor, kShiftLeft, kShiftRight,  // 32-bit integer
  kLess, kLessEqual, kEqual, kIntLess, kIntEqual, kSelect,  // comparisons give a mask, select consumes one
  kToFloat, kToInt, kBits,  // conversions; kBits reinterprets and is free
  kLoadLocal, kStoreLocal,  // tile buffer or kernel data: one access per memory-port width
  kLoadCached,              // memory through the data cache
  kCount
};
// clang-format on

/// One operation of a kernel's dataflow graph; inputs refer to earlier nodes, with one exception: a kInput whose
/// `distance` is not 0 is a loop-carried value. Its inputs[0] is the node, usually further down, that produced it
/// `distance` items ago.
struct GraphNode {
  Op op = Op::kConstant;
  std::uint32_t inputs[3] = {kNone, kNone, kNone};
  std::uint32_t bytes = 0;              ///< loads and stores: size of the record
  std::uint32_t distance = 0;           ///< loop-carried input: iterations between producer and consumer (0: same item)
  std::uint32_t value = 0;              ///< kConstant: its bits; kInput: byte offset of the field in its record
  std::string label{};                  ///< "left.normal.x": for listings; of loads and stores the name of the memory
  std::vector<std::uint32_t> stored{};  ///< kStoreLocal: the record's values, one per 4 bytes; inputs[0] is its index
  static constexpr std::uint32_t kNone = 0xffffffffU;
};

/// The dataflow graph of one kernel, recorded from its only source. Nodes are in topological order.
struct Graph {
  std::string kernel;
  std::vector<GraphNode> nodes;
};

/// Calls f(id) for every node that `node` depends on, stored values included.
template <class Function>
void for_each_input(const GraphNode& node, Function&& f) {
  for (const std::uint32_t id : node.inputs) {
    if (id != GraphNode::kNone) f(id);
  }
  for (const std::uint32_t id : node.stored) f(id);
}

}  // namespace kernels
