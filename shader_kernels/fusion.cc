#include "shader_kernels/fusion.h"

#include <algorithm>
#include <cstdint>
#include <map>
#include <stdexcept>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

namespace kernels {
namespace {

constexpr std::uint32_t kNone = GraphNode::kNone;

class Fuser {
 public:
  Fuser(const Graph& graph, std::span<const std::string_view> registers)
      : from_(graph), registers_(registers), node_of_(graph.nodes.size(), kNone), record_of_(graph.nodes.size()) {}

  std::vector<GraphNode> fused() {
    for (std::uint32_t i = 0; i < from_.nodes.size(); ++i) node_of_[i] = take(i);
    for (GraphNode& node : to_) {
      if (node.distance != 0) node.inputs[0] = node_of_[node.inputs[0]];  // set last, because the producer comes later
    }
    return std::move(to_);
  }

 private:
  /// Address of a record: its memory and index values.
  using Address = std::tuple<std::string, std::uint32_t, std::uint32_t, std::uint32_t>;
  struct Record {
    std::uint32_t load = kNone;   ///< node that loads the record
    std::uint32_t store = kNone;  ///< last node that stores the record
    std::vector<std::uint32_t> words;
  };
  using Operation = std::tuple<Op, std::uint32_t, std::uint32_t, std::uint32_t, std::uint32_t, std::string>;

  /// Adds node `i` or reuses an equal one; returns its new number.
  std::uint32_t take(std::uint32_t i) {
    GraphNode node = from_.nodes[i];
    if (node.distance != 0) return add(std::move(node));
    const bool is_field = node.op == Op::kInput && node.inputs[0] != kNone;
    if (is_field) return field(record_of_[node.inputs[0]], node);
    for (std::uint32_t& id : node.inputs) id = id == kNone ? kNone : node_of_[id];
    for (std::uint32_t& id : node.stored) id = node_of_[id];
    if (node.op == Op::kLoadLocal || node.op == Op::kLoadCached) return load(i, std::move(node));
    if (node.op == Op::kStoreLocal) return store(std::move(node));
    const Operation same{node.op, node.inputs[0], node.inputs[1], node.inputs[2], node.value, node.label};
    const auto [at, is_new] = operations_.try_emplace(same, kNone);
    if (is_new) at->second = add(std::move(node));
    return at->second;
  }

  std::uint32_t add(GraphNode node) {
    to_.push_back(std::move(node));
    return static_cast<std::uint32_t>(to_.size() - 1);
  }

  std::uint32_t field(const Address& address, GraphNode& node) {
    Record& record = records_.at(address);
    std::uint32_t& word = record.words[node.value / 4];
    if (word != kNone) return word;
    node.inputs[0] = record.load;
    return word = add(std::move(node));
  }

  std::uint32_t load(std::uint32_t i, GraphNode node) {
    const Address address = address_of(node);
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
    return record.load = add(std::move(node));
  }

  std::uint32_t store(GraphNode node) {
    const Address address = address_of(node);
    // A store under another index may overwrite the same record.
    std::erase_if(records_, [&](const auto& r) {
      return std::get<0>(r.first) == node.label && r.first != address && r.second.store == kNone;
    });
    Record& record = records_[address];
    if (record.store != kNone && !is_register(node.label)) to_[record.store] = {};  // drops the overwritten store
    record.words = node.stored;
    record.store = static_cast<std::uint32_t>(to_.size());
    return is_register(node.label) ? kNone : add(std::move(node));
  }

  static Address address_of(const GraphNode& node) {
    return {node.label, node.inputs[0], node.inputs[1], node.inputs[2]};
  }
  bool is_register(std::string_view memory) const { return std::ranges::find(registers_, memory) != registers_.end(); }

  const Graph& from_;
  const std::span<const std::string_view> registers_;
  std::vector<GraphNode> to_;
  std::vector<std::uint32_t> node_of_;
  std::vector<Address> record_of_;  ///< address of each load
  std::map<Address, Record> records_;
  std::map<Operation, std::uint32_t> operations_;
};

}  // namespace

void keep_in_registers(Graph& graph, std::span<const std::string_view> registers) {
  graph.nodes = Fuser(graph, registers).fused();
}

}  // namespace kernels
