#include "hw_models/srp/schedule_graph.h"

#include <algorithm>
#include <array>
#include <iterator>
#include <stdexcept>
#include <vector>

namespace hw {

using kernels::Graph;
using kernels::GraphNode;
using kernels::Op;

namespace {

/// True if following `links` from any node leads to a cycle. `links`: next node of each node, or kNone.
bool has_cycle(const std::vector<std::uint32_t>& links) {
  std::vector<std::uint32_t> met_from(links.size(), GraphNode::kNone);
  for (std::uint32_t first = 0; first < links.size(); ++first) {
    std::uint32_t at = first;
    for (; at != GraphNode::kNone && met_from[at] == GraphNode::kNone; at = links[at]) met_from[at] = first;
    if (at != GraphNode::kNone && met_from[at] == first) return true;
  }
  return false;
}

}  // namespace

ScheduleGraph::ScheduleGraph(const Graph& graph, const SrpConfig& config)
    : cache_width_(static_cast<std::uint32_t>(config.array.cache_port_width.bytes)),
      product_latency_(config.latency.fp_mul),
      fused_(graph.nodes.size(), false) {
  if (config.array.mul_add) fuse_products(graph);
  const auto nodes = static_cast<std::uint32_t>(graph.nodes.size());
  for (std::uint32_t id = 0; id < nodes; ++id) add_operations(graph.nodes[id], id, config.latency);
  for (std::uint32_t id = 0; id < nodes; ++id) add_dependences(graph, id);
}

/// Fuses each addition with its first operand that is a product and has no other use, into one multiply-add.
void ScheduleGraph::fuse_products(const Graph& graph) {
  std::vector<std::uint32_t> uses(graph.nodes.size());
  for (const GraphNode& node : graph.nodes) kernels::for_each_input(node, [&](std::uint32_t id) { ++uses[id]; });
  for (const GraphNode& node : graph.nodes) {
    if (op_class_of(node.op) != OpClass::kFpAdd) continue;
    const auto product = std::ranges::find_if(node.inputs, [&](std::uint32_t id) {
      return id != GraphNode::kNone && graph.nodes[id].op == Op::kMul && uses[id] == 1;
    });
    if (product != std::end(node.inputs)) fused_[*product] = true;
  }
}

bool ScheduleGraph::is_fused_addition(const GraphNode& node) const {
  return op_class_of(node.op) == OpClass::kFpAdd &&
         std::ranges::any_of(node.inputs, [&](std::uint32_t id) { return id != GraphNode::kNone && fused_[id]; });
}

void ScheduleGraph::add_operations(const GraphNode& node, std::uint32_t id, const OpLatencyConfig& latency) {
  const OpClass kind = is_fused_addition(node) ? OpClass::kFpMulAdd : op_class_of(node.op);
  first_.push_back(static_cast<std::uint32_t>(operations_.size()));
  if (kind == OpClass::kFree || fused_[id]) return;
  const std::uint32_t parts =
      is_memory_class(kind) ? std::max(1U, (node.bytes + access_bytes(kind) - 1) / access_bytes(kind)) : 1;
  for (std::uint32_t part = 0; part < parts; ++part) {
    operations_.push_back({kind, id, part, latency_of(kind, latency), occupancy_of(kind, latency)});
  }
}

void ScheduleGraph::add_dependences(const Graph& graph, std::uint32_t id) {
  const GraphNode& node = graph.nodes[id];
  for (std::uint32_t op = first_[id]; op < operations_.size() && operations_[op].node == id; ++op) {
    const bool multiplies = operations_[op].kind == OpClass::kFpMulAdd;
    for (const std::uint32_t input : node.inputs) {
      if (input == GraphNode::kNone) continue;
      if (!fused_[input]) {
        add_dependence(graph, op, input, multiplies ? product_latency_ : 0);
        continue;
      }
      kernels::for_each_input(graph.nodes[input], [&](std::uint32_t factor) { add_dependence(graph, op, factor, 0); });
    }
    const std::size_t word = std::size_t{operations_[op].part} * kPortBytes / 4;
    for (std::size_t w = word; w < std::min(word + kPortBytes / 4, node.stored.size()); ++w) {
      add_dependence(graph, op, node.stored[w], 0);
    }
  }
}

void ScheduleGraph::add_dependence(const Graph& graph, std::uint32_t operation, std::uint32_t on_node,
                                   std::uint32_t after) {
  const Source source = source_of(graph, on_node);
  if (source.operation != GraphNode::kNone)
    dependences_.push_back({source.operation, operation, source.distance, after});
}

ScheduleGraph::Source ScheduleGraph::source_of(const Graph& graph, std::uint32_t id) const {
  std::uint32_t distance = 0;
  for (std::size_t step = 0; step <= graph.nodes.size(); ++step) {
    const GraphNode& node = graph.nodes[id];
    if (op_class_of(node.op) != OpClass::kFree) return {first_[id], distance};
    const std::uint32_t from = node.inputs[0];
    if (from == GraphNode::kNone) return {};
    const OpClass maker = op_class_of(graph.nodes[from].op);
    const bool field = node.op == Op::kInput && node.distance == 0 && is_memory_class(maker);
    if (field) return {first_[from] + node.value / access_bytes(maker), distance};
    distance += node.distance;
    id = from;
  }
  return {};  // a value passed from item to item unchanged: no operation produces it
}

std::vector<std::int64_t> ScheduleGraph::path_heights(std::uint32_t ii) const {
  std::vector<std::int64_t> height;
  for (const Operation& op : operations_) height.push_back(op.latency);
  std::vector<std::uint32_t> next(operations_.size(), GraphNode::kNone);  // next operation on the longest path
  // Bellman-Ford algorithm. If heights grow without bound, the longest paths soon contain a cycle.
  for (bool grew = true; grew;) {
    grew = false;
    for (auto d = dependences_.rbegin(); d != dependences_.rend(); ++d) {
      const std::int64_t through = height[d->to] + operations_[d->from].latency - std::int64_t{d->after} -
                                   std::int64_t{ii} * std::int64_t{d->distance};
      if (through <= height[d->from]) continue;
      height[d->from] = through;
      next[d->from] = d->to;
      grew = true;
    }
    if (grew && has_cycle(next)) return {};
  }
  return height;
}

std::uint32_t ScheduleGraph::recurrence_interval() const {
  if (operations_.empty()) return 0;
  std::uint64_t latencies = 0;
  for (const Operation& op : operations_) latencies += op.latency;
  for (std::uint32_t ii = 0; ii <= latencies; ++ii) {
    if (!path_heights(ii).empty()) return ii;
  }
  throw std::invalid_argument("a kernel's value depends on itself within one item");
}

namespace {

std::uint32_t ceil_div(std::uint32_t a, std::uint32_t b) { return (a + b - 1) / b; }

}  // namespace

Pool pool_of(OpClass op_class) {
  if (op_class == OpClass::kCachedRead) return Pool::kCache;
  return is_memory_class(op_class) ? Pool::kLocal : Pool::kArray;
}

std::uint32_t pool_size(Pool pool, const ArrayConfig& array) {
  switch (pool) {
    case Pool::kLocal:
      return array.local_ports;
    case Pool::kCache:
      return array.cache_ports;
    default:
      return array.unit_count();
  }
}

std::uint32_t capable_units(OpClass op_class, const ArrayConfig& array) {
  if (op_class == OpClass::kFpDivSqrt) return array.div_sqrt_units;
  if (op_class == OpClass::kFpMul || op_class == OpClass::kFpMulAdd || op_class == OpClass::kIntMul)
    return array.mul_units;
  return pool_size(pool_of(op_class), array);
}

std::uint32_t resource_interval(const std::vector<Operation>& operations, const ArrayConfig& array) {
  struct Demand {
    std::uint32_t operations = 0, busy = 0, longest = 0;
  };
  std::array<Demand, kOpClasses> demands;
  for (const Operation& op : operations) {
    Demand& demand = demands[static_cast<std::size_t>(op.kind)];
    demand.operations += 1;
    demand.busy += op.occupancy;
    demand.longest = std::max(demand.longest, op.occupancy);
  }
  std::uint32_t ii = 1;
  for (std::size_t kind = 0; kind < demands.size(); ++kind) {
    const Demand& demand = demands[kind];
    if (demand.operations == 0) continue;
    // Operations of all classes that can use only these units must share them.
    const auto own = static_cast<OpClass>(kind);
    const std::uint32_t units = capable_units(own, array);
    std::uint32_t busy = 0;
    for (std::size_t other = 0; other < demands.size(); ++other) {
      const auto c = static_cast<OpClass>(other);
      if (pool_of(c) == pool_of(own) && capable_units(c, array) <= units) busy += demands[other].busy;
    }
    ii = std::max({ii, ceil_div(busy, units), ceil_div(demand.operations, units) * demand.longest});
  }
  return ii;
}

}  // namespace hw
