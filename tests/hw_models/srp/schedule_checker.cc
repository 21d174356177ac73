#include "tests/hw_models/srp/schedule_checker.h"

#include <cstdint>
#include <map>
#include <set>
#include <tuple>

#include <fmt/format.h>

namespace hw::test {
namespace {

using kernels::GraphNode;
using kernels::Op;

class Player {
 public:
  Player(const KernelSchedule& schedule, const kernels::Graph& graph, const SrpConfig& config)
      : schedule_(schedule), graph_(graph), config_(config) {
    for (const Placement& p : schedule.placements) placed_[{p.node, p.part}] = &p;
    if (config.array.mul_add) fuse();
  }

  std::string play() {
    complete();
    // Enough items that all items that overlap with the first are included, and the longest loop-carried distance.
    const std::uint32_t items = schedule_.depth / schedule_.ii + 6;
    for (std::uint32_t item = 0; item < items; ++item) {
      for (const Placement& p : schedule_.placements) {
        reserve(p, item);
        check_inputs(p, item);
        const std::uint32_t ends = p.start + latency(p.node);
        if (ends > schedule_.depth) complain(p, item, "ends after the schedule");
      }
    }
    return wrong_;
  }

 private:
  void complain(const Placement& p, std::uint32_t item, const std::string& what) {
    wrong_ += fmt::format("{}: node {} part {} of item {} {}\n", graph_.kernel, p.node, p.part, item, what);
  }

  void complete() {
    std::size_t expected = 0;
    for (std::uint32_t id = 0; id < graph_.nodes.size(); ++id) {
      const GraphNode& node = graph_.nodes[id];
      const OpClass kind = op_class_of(node.op);
      if (kind == OpClass::kFree || is_fused(id)) continue;
      const std::uint32_t parts = is_memory_class(kind) ? (node.bytes + width(kind) - 1) / width(kind) : 1;
      for (std::uint32_t part = 0; part < parts; ++part) {
        if (!placed_.contains({id, part})) wrong_ += fmt::format("node {} part {} has no place\n", id, part);
      }
      expected += parts;
    }
    if (expected != schedule_.placements.size()) wrong_ += "placements that no node asks for\n";
  }

  void reserve(const Placement& p, std::uint32_t item) {
    const OpClass kind = op_class_of(graph_.nodes[p.node].op);
    const ArrayConfig& array = config_.array;
    std::uint32_t units = array.unit_count();
    int pool = 0;
    if (kind == OpClass::kFpMul || kind == OpClass::kIntMul || product_of_.contains(p.node)) units = array.mul_units;
    if (kind == OpClass::kFpDivSqrt) units = array.div_sqrt_units;
    if (kind == OpClass::kLocalRead || kind == OpClass::kLocalWrite) pool = 1, units = array.local_ports;
    if (kind == OpClass::kCachedRead) pool = 2, units = array.cache_ports;
    if (p.unit >= units) complain(p, item, "sits on a unit that cannot do it");
    const std::uint32_t keeps = kind == OpClass::kFpDivSqrt ? config_.latency.div_sqrt_interval : 1;
    for (std::uint32_t c = 0; c < keeps; ++c) {
      if (!used_.insert({{pool, p.unit, item * schedule_.ii + p.start + c}, 0}).second) {
        complain(p, item, "finds its unit taken");
      }
    }
  }

  void check_inputs(const Placement& p, std::uint32_t item) {
    const GraphNode& node = graph_.nodes[p.node];
    const std::uint64_t now = std::uint64_t{item} * schedule_.ii + p.start;
    const auto product = product_of_.find(p.node);
    for (const std::uint32_t input : node.inputs) {
      if (input == GraphNode::kNone || is_fused(input)) continue;
      const std::uint64_t read = now + (product == product_of_.end() ? 0 : config_.latency.fp_mul);
      if (there_at(input, item) > read) complain(p, item, "uses an input too early");
    }
    if (product != product_of_.end()) {
      for (const std::uint32_t factor : graph_.nodes[product->second].inputs) {
        if (factor != GraphNode::kNone && there_at(factor, item) > now) complain(p, item, "uses a factor too early");
      }
    }
    for (std::size_t word = 0; word < node.stored.size(); ++word) {
      if (word / 4 == p.part && there_at(node.stored[word], item) > now) complain(p, item, "stores a value too early");
    }
  }

  /// Returns the cycle from which the value of node `id` for `item` can be used; 0 for values from before the loop.
  std::uint64_t there_at(std::uint32_t id, std::uint32_t item) const {
    const GraphNode& node = graph_.nodes[id];
    if (op_class_of(node.op) != OpClass::kFree) return made_at(id, 0, item);
    if (node.inputs[0] == GraphNode::kNone) return 0;
    if (node.distance > item) return 0;
    const bool loaded = node.op == Op::kInput && is_memory_class(op_class_of(graph_.nodes[node.inputs[0]].op));
    if (loaded && node.distance == 0) {
      return made_at(node.inputs[0], node.value / width(op_class_of(graph_.nodes[node.inputs[0]].op)), item);
    }
    return there_at(node.inputs[0], item - node.distance);
  }
  std::uint32_t width(OpClass kind) const {
    return kind == OpClass::kCachedRead ? static_cast<std::uint32_t>(config_.array.cache_port_width.bytes) : 16;
  }
  std::uint64_t made_at(std::uint32_t id, std::uint32_t part, std::uint32_t item) const {
    const auto at = placed_.find({id, part});
    if (at == placed_.end()) return 0;
    return std::uint64_t{item} * schedule_.ii + at->second->start + latency(id);
  }

  /// Finds multiply-adds: pairs of an addition or subtraction and its first operand that is a product without other
  /// use.
  void fuse() {
    std::map<std::uint32_t, int> uses;
    for (const GraphNode& node : graph_.nodes) kernels::for_each_input(node, [&](std::uint32_t id) { ++uses[id]; });
    for (std::uint32_t id = 0; id < graph_.nodes.size(); ++id) {
      const GraphNode& node = graph_.nodes[id];
      if (node.op != Op::kAdd && node.op != Op::kSub) continue;
      for (const std::uint32_t input : {node.inputs[0], node.inputs[1]}) {
        if (graph_.nodes[input].op == Op::kMul && uses[input] == 1 && product_of_.emplace(id, input).second) {
          fused_.insert(input);
        }
      }
    }
  }
  bool is_fused(std::uint32_t id) const { return fused_.contains(id); }
  std::uint32_t latency(std::uint32_t id) const {
    const std::uint32_t own = latency_of(op_class_of(graph_.nodes[id].op), config_.latency);
    return product_of_.contains(id) ? own + config_.latency.fp_mul : own;
  }

  const KernelSchedule& schedule_;
  const kernels::Graph& graph_;
  const SrpConfig& config_;
  std::map<std::pair<std::uint32_t, std::uint32_t>, const Placement*> placed_;
  std::map<std::tuple<int, std::uint32_t, std::uint32_t>, int> used_;
  std::map<std::uint32_t, std::uint32_t> product_of_;  ///< multiply-adds: the addition's node and its product
  std::set<std::uint32_t> fused_;                      ///< products of multiply-adds
  std::string wrong_;
};

}  // namespace

std::string first_schedule_error(const KernelSchedule& schedule, const kernels::Graph& graph, const SrpConfig& config) {
  return Player(schedule, graph, config).play();
}

}  // namespace hw::test
