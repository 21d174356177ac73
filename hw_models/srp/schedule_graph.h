#pragma once
#include <cstdint>
#include <vector>

#include "hw_models/srp/op_table.h"
#include "hw_models/srp/srp_config.h"
#include "shader_kernels/graph.h"

namespace hw {

/// Unit of scheduling: an operation of a kernel, or a 16-byte access of one of its loads or stores.
struct Operation {
  OpClass kind = OpClass::kFree;
  std::uint32_t node = 0;
  std::uint32_t part = 0;
  std::uint32_t latency = 0;
  std::uint32_t occupancy = 1;
};

/// `to` of an item uses what `from` made `distance` items before.
struct Dependence {
  std::uint32_t from = 0;
  std::uint32_t to = 0;
  std::uint32_t distance = 0;
};

/// Dependence graph of a kernel: operations and accesses, without what costs nothing.
class ScheduleGraph {
 public:
  ScheduleGraph(const kernels::Graph& graph, const OpLatencyConfig& latency);

  const std::vector<Operation>& operations() const { return operations_; }
  const std::vector<Dependence>& dependences() const { return dependences_; }

  /// For each operation the longest way, in cycles, from its issue to the end of its item or of a later one, when
  /// items start every `ii` cycles. Empty if `ii` is too short for a value handed from item to item.
  std::vector<std::int64_t> heights(std::uint32_t ii) const;
  /// The least interval for which there are heights.
  std::uint32_t recurrence_interval() const;

 private:
  /// Where a value comes from: an operation of this or an earlier item, or kNone (a constant, the item's number).
  struct Source {
    std::uint32_t operation = kernels::GraphNode::kNone;
    std::uint32_t distance = 0;
  };

  void add_operations(const kernels::GraphNode& node, std::uint32_t id, const OpLatencyConfig& latency);
  void add_dependences(const kernels::Graph& graph, std::uint32_t id);
  void depend(const kernels::Graph& graph, std::uint32_t operation, std::uint32_t on_node);
  Source source_of(const kernels::Graph& graph, std::uint32_t id) const;

  std::vector<std::uint32_t> first_;  ///< operation of each node
  std::vector<Operation> operations_;
  std::vector<Dependence> dependences_;
};

/// Bytes that a memory port moves in a cycle.
inline constexpr std::uint32_t kPortBytes = 16;

}  // namespace hw
