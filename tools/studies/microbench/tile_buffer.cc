#include <algorithm>
#include <map>

#include <fmt/format.h>

#include "hw_models/machines/gpu_config.h"
#include "hw_models/srp/bank_conflicts.h"
#include "hw_models/srp/schedule_graph.h"
#include "shader_kernels/catalogue.h"
#include "tools/studies/microbench/benchmark.h"

namespace tools {
namespace {

using kernels::GraphNode;
using kernels::Op;

constexpr std::uint64_t kItems = 1024;  // a multiple of every number of banks

/// A kernel that reads a record of each of two arrays and writes one of a third.
kernels::Graph copy_kernel(std::uint32_t record_bytes) {
  kernels::Graph graph{"records", {}};
  const auto add = [&](GraphNode node) {
    graph.nodes.push_back(std::move(node));
    return static_cast<std::uint32_t>(graph.nodes.size() - 1);
  };
  const std::uint32_t item = add({.op = Op::kInput});
  std::vector<std::uint32_t> values;
  for (const char* array : {"a", "b"}) {
    GraphNode load{.op = Op::kLoadLocal, .bytes = record_bytes, .label = array};
    load.inputs[0] = item;
    const std::uint32_t record = add(load);
    for (std::uint32_t byte = 0; byte < record_bytes; byte += 4) {
      GraphNode field{.op = Op::kInput, .value = byte};
      field.inputs[0] = record;
      values.push_back(add(field));
    }
  }
  values.resize(record_bytes / 4);
  GraphNode store{.op = Op::kStoreLocal, .bytes = record_bytes, .label = "c", .stored = values};
  store.inputs[0] = item;
  add(store);
  return graph;
}

/// Cycles lost per item, counted access by access over many items in the middle of a loop.
double counted_conflicts(const hw::KernelSchedule& schedule, const kernels::Graph& graph, std::uint32_t banks) {
  struct Access {
    std::uint64_t first_word, words, start;
    const GraphNode* constant;
  };
  std::map<std::string, std::uint64_t> arrays;
  std::uint64_t end = 0;
  const auto is_local = [](const GraphNode& node) { return node.op == Op::kLoadLocal || node.op == Op::kStoreLocal; };
  const auto words = [](const GraphNode& node) {
    return std::max<std::uint64_t>(1, (node.bytes + hw::kPortBytes - 1) / hw::kPortBytes);
  };
  for (const GraphNode& node : graph.nodes) {
    if (is_local(node) && arrays.emplace(node.label, end).second) end += words(node);
  }
  std::vector<Access> accesses;
  for (const hw::Placement& p : schedule.placements) {
    const GraphNode& node = graph.nodes[p.node];
    if (!is_local(node)) continue;
    const std::uint32_t index = node.inputs[0];
    const bool constant = index != GraphNode::kNone && graph.nodes[index].op == Op::kConstant;
    accesses.push_back(
        {arrays.at(node.label) + p.part, words(node), p.start, constant ? &graph.nodes[index] : nullptr});
  }
  const std::uint64_t full = (schedule.depth / schedule.ii + banks) / banks * banks;  // items until the loop is full
  std::uint64_t lost = 0;
  std::vector<std::uint32_t> in_bank(banks);
  for (std::uint64_t cycle = full * schedule.ii; cycle < (full + kItems) * schedule.ii; ++cycle) {
    std::ranges::fill(in_bank, 0);
    for (const Access& a : accesses) {
      if ((cycle - a.start) % schedule.ii != 0) continue;
      const std::uint64_t record = a.constant != nullptr ? a.constant->value : (cycle - a.start) / schedule.ii;
      in_bank[(a.first_word + record * a.words) % banks] += 1;
    }
    const std::uint32_t most = std::ranges::max(in_bank);
    lost += most > 1 ? most - 1 : 0;
  }
  return static_cast<double>(lost) / kItems;
}

Findings measure(const hw::SrpConfig& srp) {
  Findings found{"local memory, an item of a loop", {}};
  const auto modelled = [](const hw::KernelSchedule& schedule, const kernels::Graph& graph, std::uint32_t banks) {
    return static_cast<double>(hw::bank_conflicts(schedule, graph, banks).of(kItems)) / kItems;
  };
  for (const std::uint32_t stride : {16U, 32U, 48U, 64U}) {
    const kernels::Graph graph = copy_kernel(stride);
    const hw::KernelSchedule schedule = hw::schedule(graph, srp);
    for (std::uint32_t banks = 1; banks <= 64; banks *= 2) {
      found.figures.push_back({fmt::format("stride {} B, {} bank{}", stride, banks, banks == 1 ? "" : "s"), "cycles",
                               modelled(schedule, graph, banks), counted_conflicts(schedule, graph, banks),
                               Figure::Holds::kExactly, fmt::format("II {}", schedule.ii)});
    }
  }
  std::vector<hw::KernelSchedule> schedules;
  std::uint32_t intervals = 0;
  for (const kernels::KernelInfo& kernel : kernels::kernel_catalogue())
    intervals += schedules.emplace_back(hw::schedule(kernel.graph, srp)).ii;
  for (std::uint32_t banks = 1; banks <= 64; banks *= 2) {
    Figure sum{fmt::format("all kernels, {} bank{}", banks, banks == 1 ? "" : "s"), "cycles"};
    sum.remark = fmt::format("II {} in all", intervals);
    for (const kernels::KernelInfo& kernel : kernels::kernel_catalogue()) {
      sum.measured += modelled(schedules[kernel.id], kernel.graph, banks);
      sum.expected += counted_conflicts(schedules[kernel.id], kernel.graph, banks);
    }
    found.figures.push_back(sum);
  }
  return found;
}

}  // namespace

Benchmark tile_buffer_benchmark() {
  return {"tile_buffer",
          "Cycles lost to bank conflicts in local memory, by the length of records and number of banks",
          "What the machine charges a kernel beside a count of every access of 1024 items. The first kernel reads\n"
          "a record of each of two arrays and writes one of a third; then all kernels of the catalogue, added up.\n"
          "\n"
          "Example: raywatt microbench tile_buffer --set srp.array.local_ports=8",
          {json_option()},
          [](const BenchmarkJob& job) { return measure(real_machine(job.machine).gpu->srp); }};
}

}  // namespace tools
