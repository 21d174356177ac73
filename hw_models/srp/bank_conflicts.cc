#include "hw_models/srp/bank_conflicts.h"

#include <algorithm>
#include <map>
#include <string>
#include <vector>

#include "hw_models/srp/schedule_graph.h"

namespace hw {

using kernels::GraphNode;
using kernels::Op;

namespace {

/// A local memory access that every item of a loop makes. `slot`: cycle of the access within the initiation interval.
/// `behind`: number of younger items that have started before the access.
struct LocalAccess {
  std::uint32_t slot = 0, behind = 0;
  std::uint32_t words = 1;  ///< length of the accessed record in 16-byte words
  std::uint32_t part = 0;   ///< bank of the accessed word if the record's index is 0 (modulo the number of banks)
  bool constant = false;
  std::uint32_t index = 0;  ///< index of the accessed record, if it is constant
};

bool is_local(const GraphNode& node) { return node.op == Op::kLoadLocal || node.op == Op::kStoreLocal; }
std::uint32_t word_count_of(const GraphNode& node) { return std::max(1U, (node.bytes + kPortBytes - 1) / kPortBytes); }

std::vector<LocalAccess> accesses_of(const KernelSchedule& schedule, const kernels::Graph& graph) {
  std::map<std::string, std::uint32_t> begins;  // first bank of each array
  std::uint32_t end = 0;
  for (const GraphNode& node : graph.nodes) {
    if (!is_local(node) || !begins.emplace(node.label, end).second) continue;
    end += word_count_of(node);
  }
  std::vector<LocalAccess> accesses;
  for (const Placement& p : schedule.placements) {
    const GraphNode& node = graph.nodes[p.node];
    if (!is_local(node)) continue;
    LocalAccess a{p.start % schedule.ii, p.start / schedule.ii, word_count_of(node), begins.at(node.label) + p.part};
    if (node.inputs[0] != GraphNode::kNone && graph.nodes[node.inputs[0]].op == Op::kConstant) {
      a.constant = true;
      a.index = graph.nodes[node.inputs[0]].value;
    }
    accesses.push_back(a);
  }
  return accesses;
}

}  // namespace

BankConflicts bank_conflicts(const KernelSchedule& schedule, const kernels::Graph& graph, std::uint32_t bank_count) {
  const std::vector<LocalAccess> accesses = accesses_of(schedule, graph);
  BankConflicts conflicts{0, bank_count};
  std::vector<std::uint32_t> used(bank_count);
  for (std::uint32_t item = 0; item < bank_count; ++item) {  // the conflicts repeat every `bank_count` items
    for (std::uint32_t slot = 0; slot < schedule.ii; ++slot) {
      std::ranges::fill(used, 0);
      std::uint32_t most = 0;
      for (const LocalAccess& a : accesses) {
        if (a.slot != slot) continue;
        // A negative difference wraps modulo 2^32, which is a multiple of `bank_count`.
        const std::uint32_t record = a.constant ? a.index : item - a.behind;
        most = std::max(most, ++used[(record * a.words + a.part) % bank_count]);
      }
      conflicts.cycles += most > 1 ? most - 1 : 0;
    }
  }
  return conflicts;
}

}  // namespace hw
