#include "shader_kernels/graph.h"

#include <algorithm>
#include <bit>
#include <cstdint>
#include <map>
#include <stdexcept>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include <fmt/format.h>

namespace kernels {
namespace {

constexpr std::array<std::string_view, static_cast<std::size_t>(Op::kCount)> kNames = {
    "input",     "constant", "add",        "sub",         "mul",     "div",        "sqrt",        "min",
    "max",       "abs",      "neg",        "floor",       "int_add", "int_sub",    "int_mul",     "and",
    "or",        "xor",      "shift_left", "shift_right", "less",    "less_equal", "equal",       "int_less",
    "int_equal", "select",   "to_float",   "to_int",      "bits",    "load_local", "store_local", "load_cached"};

bool is_memory(Op op) { return op == Op::kLoadLocal || op == Op::kStoreLocal || op == Op::kLoadCached; }

std::string operand_text(const GraphNode& node) {
  if (node.op == Op::kConstant && node.label.empty()) {
    return fmt::format(" {:#x} ({})", node.value, std::bit_cast<float>(node.value));
  }
  std::string text;
  for_each_input(node, [&](std::uint32_t id) { text += fmt::format(" %{}", id); });
  if (node.distance != 0) text += fmt::format(" from {} item{} ago", node.distance, node.distance == 1 ? "" : "s");
  if (node.bytes != 0) text += fmt::format(" ({} bytes)", node.bytes);
  if (!node.label.empty()) text += "  " + node.label;
  return text;
}

}  // namespace

std::string_view name_of(Op op) { return kNames[static_cast<std::size_t>(op)]; }

OpCounts count_ops(const Graph& graph) {
  OpCounts counts{};
  for (const GraphNode& node : graph.nodes) ++counts[static_cast<std::size_t>(node.op)];
  return counts;
}

std::uint32_t count_executed_ops(const Graph& graph) {
  std::uint32_t ops = 0;
  for (const GraphNode& node : graph.nodes) {
    ops += node.op != Op::kInput && node.op != Op::kConstant && node.op != Op::kBits ? 1U : 0U;
  }
  return ops;
}

std::string operation_summary(const Graph& graph) {
  std::string text = fmt::format("{}: {} operations\n", graph.kernel, count_executed_ops(graph));
  const OpCounts counts = count_ops(graph);
  for (std::size_t op = 0; op < counts.size(); ++op) {
    if (counts[op] != 0) text += fmt::format("  {:<12}{:>5}\n", kNames[op], counts[op]);
  }
  for (const GraphNode& node : graph.nodes) {
    if (is_memory(node.op)) text += fmt::format("  {:<12}{:>5} bytes  {}\n", name_of(node.op), node.bytes, node.label);
  }
  return text;
}

std::string node_listing(const Graph& graph) {
  std::string text;
  for (std::size_t i = 0; i < graph.nodes.size(); ++i) {
    text += fmt::format("%{:<4} {:<12}{}\n", i, name_of(graph.nodes[i].op), operand_text(graph.nodes[i]));
  }
  return text;
}

namespace {

class Sorter {
 public:
  explicit Sorter(const std::vector<GraphNode>& nodes) : from_(nodes), index_(nodes.size(), GraphNode::kNone) {}

  std::vector<GraphNode> sort_nodes() {
    for (std::uint32_t i = 0; i < from_.size(); ++i) {
      const GraphNode& node = from_[i];
      const bool touches_memory = node.op == Op::kLoadLocal || node.op == Op::kStoreLocal || node.op == Op::kLoadCached;
      if (touches_memory || node.distance != 0) place_node(i);
      if (node.distance != 0) place_node(node.inputs[0]);
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
  void place_node(std::uint32_t i) {
    if (index_[i] != GraphNode::kNone) return;
    if (from_[i].distance == 0) for_each_input(from_[i], [this](std::uint32_t id) { place_node(id); });
    index_[i] = static_cast<std::uint32_t>(to_.size());
    to_.push_back(from_[i]);
  }

  const std::vector<GraphNode>& from_;
  std::vector<GraphNode> to_;
  std::vector<std::uint32_t> index_;
};

}  // namespace

void sort_nodes_canonically(Graph& graph) { graph.nodes = Sorter(graph.nodes).sort_nodes(); }

namespace {

constexpr std::uint32_t kNone = GraphNode::kNone;

class Fuser {
 public:
  Fuser(const Graph& graph, std::span<const std::string_view> registers)
      : from_(graph), registers_(registers), node_of_(graph.nodes.size(), kNone), record_of_(graph.nodes.size()) {}

  std::vector<GraphNode> fuse_nodes() {
    for (std::uint32_t i = 0; i < from_.nodes.size(); ++i) node_of_[i] = map_node(i);
    for (GraphNode& node : to_) {
      if (node.distance != 0) node.inputs[0] = node_of_[node.inputs[0]];  // set last: its producer may be a later node
    }
    return std::move(to_);
  }

 private:
  /// Identifies a record that a kernel accesses: the memory that contains the record, and the graph nodes that compute
  /// its index.
  using Address = std::tuple<std::string, std::uint32_t, std::uint32_t, std::uint32_t>;
  struct Record {
    std::uint32_t load = kNone;   ///< node whose load reads the record
    std::uint32_t store = kNone;  ///< last node that stores the record
    std::vector<std::uint32_t> words;
  };
  using Operation = std::tuple<Op, std::uint32_t, std::uint32_t, std::uint32_t, std::uint32_t, std::string>;

  /// Adds node `i` of the graph that is being simplified to the new graph, or reuses an equal node. Returns the node's
  /// number in the new graph.
  std::uint32_t map_node(std::uint32_t i) {
    GraphNode node = from_.nodes[i];
    if (node.distance != 0) return add_node(std::move(node));
    const bool is_field = node.op == Op::kInput && node.inputs[0] != kNone;
    if (is_field) return map_field(record_of_[node.inputs[0]], node);
    for (std::uint32_t& id : node.inputs) id = id == kNone ? kNone : node_of_[id];
    for (std::uint32_t& id : node.stored) id = node_of_[id];
    if (node.op == Op::kLoadLocal || node.op == Op::kLoadCached) return map_load(i, std::move(node));
    if (node.op == Op::kStoreLocal) return map_store(std::move(node));
    const Operation same{node.op, node.inputs[0], node.inputs[1], node.inputs[2], node.value, node.label};
    const auto [at, is_new] = operations_.try_emplace(same, kNone);
    if (is_new) at->second = add_node(std::move(node));
    return at->second;
  }

  std::uint32_t add_node(GraphNode node) {
    to_.push_back(std::move(node));
    return static_cast<std::uint32_t>(to_.size() - 1);
  }

  std::uint32_t map_field(const Address& address, GraphNode& node) {
    Record& record = records_.at(address);
    std::uint32_t& word = record.words[node.value / 4];
    if (word != kNone) return word;
    node.inputs[0] = record.load;
    return word = add_node(std::move(node));
  }

  std::uint32_t map_load(std::uint32_t i, GraphNode node) {
    const Address address = record_key(node);
    record_of_[i] = address;
    const auto known = records_.find(address);
    if (known != records_.end()) return known->second.load;
    const bool is_stored = std::ranges::any_of(
        records_, [&](const auto& r) { return std::get<0>(r.first) == node.label && r.second.store != kNone; });
    if (is_stored || is_register(node.label)) {
      throw std::logic_error("kernel '" + from_.kernel + "': a part loads from '" + node.label +
                             "' what another part may have stored under another index");
    }
    Record& record = records_[address];
    record.words.assign(node.bytes / 4, kNone);
    return record.load = add_node(std::move(node));
  }

  std::uint32_t map_store(GraphNode node) {
    const Address address = record_key(node);
    // A store under another index may overwrite this record.
    std::erase_if(records_, [&](const auto& r) {
      return std::get<0>(r.first) == node.label && r.first != address && r.second.store == kNone;
    });
    Record& record = records_[address];
    if (record.store != kNone && !is_register(node.label)) to_[record.store] = {};  // drops the overwritten store
    record.words = node.stored;
    record.store = static_cast<std::uint32_t>(to_.size());
    return is_register(node.label) ? kNone : add_node(std::move(node));
  }

  static Address record_key(const GraphNode& node) {
    return {node.label, node.inputs[0], node.inputs[1], node.inputs[2]};
  }
  bool is_register(std::string_view memory) const { return std::ranges::find(registers_, memory) != registers_.end(); }

  const Graph& from_;
  const std::span<const std::string_view> registers_;
  std::vector<GraphNode> to_;
  std::vector<std::uint32_t> node_of_;
  std::vector<Address> record_of_;  ///< for each load of the new graph, the record that it reads
  std::map<Address, Record> records_;
  std::map<Operation, std::uint32_t> operations_;
};

}  // namespace

void remove_repeated_accesses(Graph& graph, std::span<const std::string_view> registers) {
  graph.nodes = Fuser(graph, registers).fuse_nodes();
}

}  // namespace kernels
