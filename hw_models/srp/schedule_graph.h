#pragma once
#include <cstdint>
#include <vector>

#include "hw_models/srp/op_table.h"
#include "hw_models/srp/srp_config.h"
#include "shader_kernels/graph.h"

namespace hw {

/// Bytes that a port of local memory moves in a cycle.
inline constexpr std::uint32_t kPortBytes = 16;

/// Unit of scheduling: an operation of a kernel, or an access of one of its loads or stores, as wide as the port.
struct Operation {
  OpClass kind = OpClass::kFree;
  std::uint32_t node = 0;
  std::uint32_t part = 0;
  std::uint32_t latency = 0;
  std::uint32_t occupancy = 1;
};

/// `to` of an item uses what `from` made `distance` items before, `after` cycles after it is issued.
struct Dependence {
  std::uint32_t from = 0;
  std::uint32_t to = 0;
  std::uint32_t distance = 0;
  std::uint32_t after = 0;
};

/// Dependence graph of a kernel: operations and accesses, without what costs nothing.
/// On an array with multiply-add units a product that one addition or subtraction alone uses is part of that operation,
/// which reads its other operand when the product is there. So fusing takes nothing longer.
class ScheduleGraph {
 public:
  ScheduleGraph(const kernels::Graph& graph, const SrpConfig& config);

  const std::vector<Operation>& operations() const { return operations_; }
  const std::vector<Dependence>& dependences() const { return dependences_; }
  /// Node `id` is a product that is part of an addition.
  bool is_fused(std::uint32_t id) const { return fused_[id]; }

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

  void fuse_products(const kernels::Graph& graph);
  bool adds_product(const kernels::GraphNode& node) const;
  void add_operations(const kernels::GraphNode& node, std::uint32_t id, const OpLatencyConfig& latency);
  /// Bytes that one access of such a load or store moves.
  std::uint32_t width(OpClass c) const { return c == OpClass::kCachedRead ? cache_width_ : kPortBytes; }
  void add_dependences(const kernels::Graph& graph, std::uint32_t id);
  void depend(const kernels::Graph& graph, std::uint32_t operation, std::uint32_t on_node, std::uint32_t after);
  Source source_of(const kernels::Graph& graph, std::uint32_t id) const;

  std::uint32_t cache_width_;
  std::uint32_t product_latency_;     ///< cycles until a multiply-add reads its other operand
  std::vector<bool> fused_;           ///< by node
  std::vector<std::uint32_t> first_;  ///< operation of each node
  std::vector<Operation> operations_;
  std::vector<Dependence> dependences_;
};

}  // namespace hw
