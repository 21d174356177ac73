#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace kernels {

// clang-format off
/// Operations of the SRP's functional units, and memory accesses.
enum class Op : std::uint8_t {
  kInput,     ///< a field of a loaded record (free: the load is counted), or the loop's item index
  kConstant,  ///< a literal or a uniform, kept in a register for the whole loop
  kAdd, kSub, kMul, kDiv, kSqrt, kMin, kMax, kAbs, kNeg, kFloor,  // 32-bit float
  kIntAdd, kIntSub, kIntMul, kAnd, kOr, kXor, kShiftLeft, kShiftRight,  // 32-bit integer
  kLess, kLessEqual, kEqual, kIntLess, kIntEqual, kSelect,  // comparisons produce a mask, which select uses
  kToFloat, kToInt, kBits,  // conversions; kBits reinterprets and is free
  kLoadLocal, kStoreLocal,  // tile buffer or kernel data: one access per width of the memory port
  kLoadCached,              // memory, read through the data cache
  kCount
};
// clang-format on

/// One operation of a kernel's dataflow graph. Inputs refer to earlier nodes, except for a loop-carried value: a kInput
/// with a `distance` other than 0, whose inputs[0] is the (usually later) node that produced it `distance` items ago.
struct GraphNode {
  Op op = Op::kConstant;
  std::uint32_t inputs[3] = {kNone, kNone, kNone};
  std::uint32_t bytes = 0;              ///< record size of a load or store
  std::uint32_t distance = 0;           ///< loop-carried input: items between producer and consumer (0: same item)
  std::uint32_t value = 0;              ///< kConstant: its bits; kInput: the field's byte offset in its record
  std::string label{};                  ///< name for listings, such as "left.normal.x"; for a load or store, the memory
  std::vector<std::uint32_t> stored{};  ///< kStoreLocal: the record's 4-byte values; inputs[0] is its index
  static constexpr std::uint32_t kNone = 0xffffffffU;
};

/// The dataflow graph of one kernel, recorded from its source. Nodes are in topological order.
struct Graph {
  std::string kernel;
  std::vector<GraphNode> nodes;
};

/// Calls f(id) for each node that `node` depends on, including stored values.
template <class Function>
void for_each_input(const GraphNode& node, Function&& f) {
  for (const std::uint32_t id : node.inputs) {
    if (id != GraphNode::kNone) f(id);
  }
  for (const std::uint32_t id : node.stored) f(id);
}

/// Renumbers the nodes by their dependences and drops unused fields and uniforms. Loads, stores and carried values keep
/// their order, each after its inputs, operands from left to right. The graph is then independent of the order in which
/// a compiler evaluates a + b.
void sort_canonically(Graph& graph);

/// Replaces repeated memory accesses of an item in a fused kernel's graph by registers:
///
///   load, load of the same          -> one load              store, load of the same  -> the value stored
///   equal operations, equal values  -> one operation         store, store of the same -> the second
///   store to one of `registers`     -> nothing
///
/// Throws std::logic_error if a part loads a record that another part may have stored under another index.
void keep_in_registers(Graph& graph, std::span<const std::string_view> registers);

std::string_view name_of(Op op);

/// Number of a graph's nodes per operation.
using OpCounts = std::array<std::uint32_t, static_cast<std::size_t>(Op::kCount)>;
OpCounts count_ops(const Graph& graph);

/// Returns the number of operations executed by functional units: all except inputs, constants and kBits.
std::uint32_t executed_ops(const Graph& graph);

/// Returns one line per operation that occurs, then one per load and store.
std::string operation_summary(const Graph& graph);
/// Returns one line per node.
std::string node_listing(const Graph& graph);

}  // namespace kernels
