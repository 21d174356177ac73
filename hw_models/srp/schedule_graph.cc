#include "hw_models/srp/schedule_graph.h"

#include <algorithm>
#include <stdexcept>

namespace hw {

using kernels::Graph;
using kernels::GraphNode;
using kernels::Op;

ScheduleGraph::ScheduleGraph(const Graph& graph, const OpLatencyConfig& latency) {
  const auto nodes = static_cast<std::uint32_t>(graph.nodes.size());
  for (std::uint32_t id = 0; id < nodes; ++id) add_operations(graph.nodes[id], id, latency);
  for (std::uint32_t id = 0; id < nodes; ++id) add_dependences(graph, id);
}

void ScheduleGraph::add_operations(const GraphNode& node, std::uint32_t id, const OpLatencyConfig& latency) {
  const OpClass kind = class_of(node.op);
  first_.push_back(static_cast<std::uint32_t>(operations_.size()));
  if (kind == OpClass::kFree) return;
  const std::uint32_t parts = is_memory(kind) ? std::max(1U, (node.bytes + kPortBytes - 1) / kPortBytes) : 1;
  for (std::uint32_t part = 0; part < parts; ++part) {
    operations_.push_back({kind, id, part, latency_of(kind, latency), occupancy_of(kind, latency)});
  }
}

void ScheduleGraph::add_dependences(const Graph& graph, std::uint32_t id) {
  const GraphNode& node = graph.nodes[id];
  for (std::uint32_t op = first_[id]; op < operations_.size() && operations_[op].node == id; ++op) {
    for (const std::uint32_t input : node.inputs) {
      if (input != GraphNode::kNone) depend(graph, op, input);
    }
    const std::size_t word = std::size_t{operations_[op].part} * kPortBytes / 4;
    for (std::size_t w = word; w < std::min(word + kPortBytes / 4, node.stored.size()); ++w) {
      depend(graph, op, node.stored[w]);
    }
  }
}

void ScheduleGraph::depend(const Graph& graph, std::uint32_t operation, std::uint32_t on_node) {
  const Source source = source_of(graph, on_node);
  if (source.operation != GraphNode::kNone) dependences_.push_back({source.operation, operation, source.distance});
}

ScheduleGraph::Source ScheduleGraph::source_of(const Graph& graph, std::uint32_t id) const {
  std::uint32_t distance = 0;
  for (std::size_t step = 0; step <= graph.nodes.size(); ++step) {
    const GraphNode& node = graph.nodes[id];
    if (class_of(node.op) != OpClass::kFree) return {first_[id], distance};
    const std::uint32_t from = node.inputs[0];
    if (from == GraphNode::kNone) return {};
    const bool field = node.op == Op::kInput && node.distance == 0;
    if (field && is_memory(class_of(graph.nodes[from].op))) return {first_[from] + node.value / kPortBytes, distance};
    distance += node.distance;
    id = from;
  }
  return {};  // values that only hand each other on: nobody ever makes them
}

std::vector<std::int64_t> ScheduleGraph::heights(std::uint32_t ii) const {
  std::vector<std::int64_t> height;
  for (const Operation& op : operations_) height.push_back(op.latency);
  // Bellman-Ford: a way without a circle has fewer steps than there are operations.
  for (std::size_t round = 0; round <= operations_.size(); ++round) {
    bool grew = false;
    for (auto d = dependences_.rbegin(); d != dependences_.rend(); ++d) {
      const std::int64_t through =
          height[d->to] + operations_[d->from].latency - std::int64_t{ii} * std::int64_t{d->distance};
      if (through <= height[d->from]) continue;
      height[d->from] = through;
      grew = true;
    }
    if (!grew) return height;
  }
  return {};
}

std::uint32_t ScheduleGraph::recurrence_interval() const {
  if (operations_.empty()) return 0;
  std::uint64_t latencies = 0;
  for (const Operation& op : operations_) latencies += op.latency;
  for (std::uint32_t ii = 0; ii <= latencies; ++ii) {
    if (!heights(ii).empty()) return ii;
  }
  throw std::invalid_argument("a kernel's value depends on itself within one item");
}

}  // namespace hw
