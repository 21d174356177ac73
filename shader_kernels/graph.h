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
/// Operations of a kernel's graph: those of the SRP's functional units, and memory accesses.
enum class Op : std::uint8_t {
  kInput,     ///< a field of a loaded record (free, because the load is counted), or the loop's item index
  kConstant,  ///< a literal or a uniform, kept in a register during the whole loop
  kAdd, kSub, kMul, kDiv, kSqrt, kMin, kMax, kAbs, kNeg, kFloor,  // 32-bit float
  kIntAdd, kIntSub, kIntMul, kAnd, kOr, kXor, kShiftLeft, kShiftRight,  // 32-bit integer
  kLess, kLessEqual, kEqual, kIntLess, kIntEqual, kSelect,  // comparisons return a mask; kSelect reads one
  kToFloat, kToInt, kBits,  // conversions; kBits reinterprets and is free
  kLoadLocal, kStoreLocal,  // tile buffer or kernel data; a record wider than the memory port takes several cycles
  kLoadCached,              // memory, read through the data cache
  kCount
};
// clang-format on

/// One operation of a kernel's dataflow graph. Its inputs are earlier nodes, with one exception: a kInput whose
/// `distance` is not 0 is a loop-carried value. Its inputs[0] is the node, usually a later one, that produced the value
/// `distance` items ago.
struct GraphNode {
  Op op = Op::kConstant;
  std::uint32_t inputs[3] = {kNone, kNone, kNone};
  std::uint32_t bytes = 0;     ///< size of the record that a load or store accesses
  std::uint32_t distance = 0;  ///< loop-carried input: items between producer and consumer (0: same item)
  std::uint32_t value = 0;     ///< kConstant: the constant's 32 bits; kInput: byte offset of the field in its record
  std::string label{};         ///< name in listings, such as "left.normal.x"; loads and stores: name of the memory
  std::vector<std::uint32_t> stored{};  ///< for kStoreLocal: nodes that produce the stored record's 4-byte values;
                                        ///< inputs[0] produces the record's index
  static constexpr std::uint32_t kNone = 0xffffffffU;
};

/// The dataflow graph of one kernel, recorded from its C++ source. Nodes are in topological order.
struct Graph {
  std::string kernel;
  std::vector<GraphNode> nodes;
};

/// Calls f(id) for each node that `node` reads, including the values that it stores.
template <class Function>
void for_each_input(const GraphNode& node, Function&& f) {
  for (const std::uint32_t id : node.inputs) {
    if (id != GraphNode::kNone) f(id);
  }
  for (const std::uint32_t id : node.stored) f(id);
}

/// Renumbers the nodes of a graph in an order that depends only on their dependences, and drops unused nodes. Loads,
/// stores and carried values keep their order; operands precede their operation, left before right. The result does not
/// depend on the order in which a compiler evaluates a + b.
void sort_nodes_canonically(Graph& graph);

/// Removes repeated accesses to one record by the same item from the graph of a fused kernel:
///
///   load, load of the same          -> one load              store, load of the same  -> the value stored
///   equal operations, equal values  -> one operation         store, store of the same -> the second
///   store to one of `registers`     -> nothing
///
/// `registers` are the memories that only this kernel reads. Throws std::logic_error if a load may read a record that
/// an earlier part stored under another index.
void remove_repeated_accesses(Graph& graph, std::span<const std::string_view> registers);

std::string_view name_of(Op op);

/// For each operation, the number of nodes in a graph that perform it.
using OpCounts = std::array<std::uint32_t, static_cast<std::size_t>(Op::kCount)>;
OpCounts count_ops(const Graph& graph);

/// Returns the number of operations that functional units execute: all except inputs, constants and kBits.
std::uint32_t count_executed_ops(const Graph& graph);

/// Returns a summary of a graph: one line for each kind of operation with its count, then one line for each load and
/// store.
std::string operation_summary(const Graph& graph);
/// Returns the text of a graph, one line for each node.
std::string node_listing(const Graph& graph);

}  // namespace kernels
