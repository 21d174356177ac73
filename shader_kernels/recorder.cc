#include "shader_kernels/recorder.h"

#include <utility>
#include <vector>

namespace kernels {

std::uint32_t Recorder::add(GraphNode node) {
  graph_.nodes.push_back(std::move(node));
  return static_cast<std::uint32_t>(graph_.nodes.size() - 1);
}

std::uint32_t Recorder::literal(std::uint32_t bits) {
  const auto [at, is_new] = literals_.try_emplace(bits, 0);
  if (is_new) at->second = add({.op = Op::kConstant, .value = bits});
  return at->second;
}

std::uint32_t Recorder::uniform(std::string label) { return add({.op = Op::kConstant, .label = std::move(label)}); }

std::uint32_t Recorder::carried(std::string label) {
  return add({.op = Op::kInput, .distance = 1, .label = std::move(label)});
}

namespace {

class Sorter {
 public:
  explicit Sorter(const std::vector<GraphNode>& nodes) : from_(nodes), index_(nodes.size(), GraphNode::kNone) {}

  std::vector<GraphNode> sorted() {
    for (std::uint32_t i = 0; i < from_.size(); ++i) {
      const GraphNode& node = from_[i];
      const bool touches_memory = node.op == Op::kLoadLocal || node.op == Op::kStoreLocal || node.op == Op::kLoadCached;
      if (touches_memory || node.distance != 0) visit(i);
      if (node.distance != 0) visit(node.inputs[0]);
    }
    for (GraphNode& node : to_) {
      for (std::uint32_t& id : node.inputs) {
        if (id != GraphNode::kNone) id = index_[id];
      }
      for (std::uint32_t& id : node.stored) id = index_[id];
    }
    return std::move(to_);
  }

 private:
  void visit(std::uint32_t i) {
    if (index_[i] != GraphNode::kNone) return;
    if (from_[i].distance == 0) for_each_input(from_[i], [this](std::uint32_t id) { visit(id); });
    index_[i] = static_cast<std::uint32_t>(to_.size());
    to_.push_back(from_[i]);
  }

  const std::vector<GraphNode>& from_;
  std::vector<GraphNode> to_;
  std::vector<std::uint32_t> index_;
};

}  // namespace

void sort_canonically(Graph& graph) { graph.nodes = Sorter(graph.nodes).sorted(); }

}  // namespace kernels
