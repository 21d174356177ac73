#pragma once
#include <cstdint>
#include <initializer_list>
#include <utility>

#include "shader_kernels/graph.h"

namespace hw::test {

/// Builds small kernel graphs node by node. Functions return the number of the new node.
class GraphBuilder {
 public:
  using Op = kernels::Op;

  std::uint32_t constant() { return add({.op = Op::kConstant}); }
  std::uint32_t item() { return add({.op = Op::kInput}); }
  std::uint32_t op(Op op, std::initializer_list<std::uint32_t> inputs) {
    kernels::GraphNode node{.op = op};
    std::uint32_t n = 0;
    for (const std::uint32_t input : inputs) node.inputs[n++] = input;
    return add(std::move(node));
  }
  std::uint32_t load(std::uint32_t bytes, std::uint32_t index, Op op = Op::kLoadLocal, const char* array = "") {
    kernels::GraphNode node{.op = op, .bytes = bytes, .label = array};
    node.inputs[0] = index;
    return add(std::move(node));
  }
  std::uint32_t field(std::uint32_t load, std::uint32_t byte) {
    kernels::GraphNode node{.op = Op::kInput, .value = byte};
    node.inputs[0] = load;
    return add(std::move(node));
  }
  std::uint32_t store(std::uint32_t index, std::vector<std::uint32_t> values) {
    kernels::GraphNode node{.op = Op::kStoreLocal, .bytes = static_cast<std::uint32_t>(4 * values.size())};
    node.inputs[0] = index;
    node.stored = std::move(values);
    return add(std::move(node));
  }
  /// Adds a loop-carried value from `distance` items ago. close() sets the node that produces it.
  std::uint32_t carried(std::uint32_t distance = 1) { return add({.op = Op::kInput, .distance = distance}); }
  void close(std::uint32_t carried, std::uint32_t producer) { graph_.nodes[carried].inputs[0] = producer; }

  const kernels::Graph& graph() const { return graph_; }

 private:
  std::uint32_t add(kernels::GraphNode node) {
    graph_.nodes.push_back(std::move(node));
    return static_cast<std::uint32_t>(graph_.nodes.size() - 1);
  }

  kernels::Graph graph_;
};

}  // namespace hw::test
