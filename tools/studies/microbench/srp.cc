#include <algorithm>
#include <array>
#include <map>

#include <fmt/format.h>

#include "hw_models/machines/gpu_config.h"
#include "hw_models/srp/schedule.h"
#include "hw_models/srp/schedule_graph.h"
#include "shader_kernels/catalogue.h"
#include "sim/error.h"
#include "sim/io/printable.h"
#include "sim/report/table.h"
#include "tools/studies/microbench/benchmark.h"
#include "traces/scene/did_you_mean.h"

namespace tools {
namespace {

constexpr std::array<std::array<std::uint32_t, 2>, 5> kSizes = {{{2, 2}, {4, 2}, {4, 4}, {8, 4}, {8, 8}}};

/// Returns a shader core with an array of another size, but the same shares of multiplying and dividing units.
hw::SrpConfig resize_array(hw::SrpConfig srp, std::uint32_t rows, std::uint32_t columns) {
  const std::uint32_t before = srp.array.unit_count(), units = rows * columns;
  srp.array.rows = rows;
  srp.array.columns = columns;
  for (std::uint32_t* able : {&srp.array.mul_units, &srp.array.div_sqrt_units})
    *able = std::max(1U, *able * units / before);
  return srp;
}

std::vector<const kernels::KernelInfo*> find_kernels(const std::vector<std::string>& names) {
  std::vector<const kernels::KernelInfo*> list;
  if (names.empty()) {
    for (const kernels::KernelInfo& kernel : kernels::kernel_catalogue()) list.push_back(&kernel);
  }
  for (const std::string& name : names) {
    list.push_back(kernels::find_kernel(name));
    if (list.back() != nullptr) continue;
    std::vector<std::string> known;
    for (const kernels::KernelInfo& kernel : kernels::kernel_catalogue()) known.emplace_back(kernel.name);
    throw sim::InputError(fmt::format("there is no kernel '{}'{}; allowed: see raywatt kernels list",
                                      sim::printable(name), traces::did_you_mean(name, known)));
  }
  return list;
}

Findings measure_intervals(const hw::SrpConfig& srp, const std::vector<std::string>& names) {
  Findings found{"interval from item to item", {}};
  std::vector<std::string> header = {"II (bound, if less)"};
  for (const auto& [rows, columns] : kSizes) header.push_back(fmt::format("{}x{}", rows, columns));
  sim::Table table(header);
  std::size_t above = 0;
  for (const kernels::KernelInfo* kernel : find_kernels(names)) {
    std::vector<std::string> cells = {std::string(kernel->name)};
    for (const auto& [rows, columns] : kSizes) {
      const hw::KernelSchedule s = hw::schedule_kernel(kernel->graph, resize_array(srp, rows, columns));
      const std::uint32_t bound = std::max({1U, s.res_mii, s.rec_mii});
      const bool recurrence = s.rec_mii > s.res_mii;
      found.measurements.push_back({fmt::format("{}, {}x{}", kernel->name, rows, columns), "cycles", double(s.ii),
                                    double(bound), Measurement::Relation::kAtLeast,
                                    recurrence ? "recurrence" : "units and ports"});
      above += s.ii > bound ? 1 : 0;
      cells.push_back(
          fmt::format("{}{}{}", s.ii, recurrence ? "r" : "", s.ii > bound ? fmt::format(" ({})", bound) : ""));
    }
    table.add_row(cells);
  }
  found.table = table.text();
  found.notes.push_back(fmt::format(
      "r: the bound is a recurrence from item to item, not units and ports.\n{} of {} schedules exceed their bound.",
      above, found.measurements.size()));
  return found;
}

}  // namespace

Benchmark kernels_benchmark() {
  return {
      "kernels",
      "Initiation interval of kernels on arrays of several sizes, and its bounds by units and recurrences",
      "Arrays of 2x2 to 8x8 units with the configured shares of multipliers and dividers and the configured ports\n"
      "to memory. More units than the ports can feed bring no gain.\n"
      "\n"
      "Example: raywatt microbench kernels --kernel shade_diffuse --set srp.array.local_ports=8",
      {json_option(), {"--kernel", "only this kernel (repeatable)", &BenchmarkJob::kernels}},
      [](const BenchmarkJob& job) { return measure_intervals(non_ideal_machine(job.machine).gpu->srp, job.kernels); }};
}

namespace {

using kernels::GraphNode;
using kernels::Op;

constexpr std::uint64_t kItems = 1024;  // number of loop items; must be a multiple of each number of banks

/// Returns a kernel that reads one record from each of two arrays and writes one to a third.
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

/// Returns the cycles per loop item that a kernel loses to bank conflicts. Simulates each access of many loop items.
double count_bank_conflicts(const hw::KernelSchedule& schedule, const kernels::Graph& graph, std::uint32_t banks) {
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
  const std::uint64_t full =
      (schedule.depth / schedule.ii + banks) / banks * banks;  // number of items until the pipeline is full
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

Findings measure_conflicts(const hw::SrpConfig& srp) {
  Findings found{"local memory, an item of a loop", {}};
  const auto modelled = [](const hw::KernelSchedule& schedule, const kernels::Graph& graph, std::uint32_t banks) {
    return static_cast<double>(hw::bank_conflicts(schedule, graph, banks).stall_cycles(kItems)) / kItems;
  };
  for (const std::uint32_t stride : {16U, 32U, 48U, 64U}) {
    const kernels::Graph graph = copy_kernel(stride);
    const hw::KernelSchedule schedule = hw::schedule_kernel(graph, srp);
    for (std::uint32_t banks = 1; banks <= 64; banks *= 2) {
      found.measurements.push_back({fmt::format("stride {} B, {} bank{}", stride, banks, banks == 1 ? "" : "s"),
                                    "cycles", modelled(schedule, graph, banks),
                                    count_bank_conflicts(schedule, graph, banks), Measurement::Relation::kExactly,
                                    fmt::format("II {}", schedule.ii)});
    }
  }
  std::vector<hw::KernelSchedule> schedules;
  std::uint32_t intervals = 0;
  for (const kernels::KernelInfo& kernel : kernels::kernel_catalogue())
    intervals += schedules.emplace_back(hw::schedule_kernel(kernel.graph, srp)).ii;
  for (std::uint32_t banks = 1; banks <= 64; banks *= 2) {
    Measurement sum{fmt::format("all kernels, {} bank{}", banks, banks == 1 ? "" : "s"), "cycles"};
    sum.remark = fmt::format("II {} in all", intervals);
    for (const kernels::KernelInfo& kernel : kernels::kernel_catalogue()) {
      sum.measured += modelled(schedules[kernel.id], kernel.graph, banks);
      sum.expected += count_bank_conflicts(schedules[kernel.id], kernel.graph, banks);
    }
    found.measurements.push_back(sum);
  }
  return found;
}

}  // namespace

Benchmark tile_buffer_benchmark() {
  return {
      "tile_buffer",
      "Cycles lost to bank conflicts in local memory, by record length and number of banks",
      "Compares the cycles that the machine charges a kernel with a count of every access of 1024 items. The first\n"
      "kernel reads a record of each of two arrays and writes one of a third; then the sum over all kernels.\n"
      "\n"
      "Example: raywatt microbench tile_buffer --set srp.array.local_ports=8",
      {json_option()},
      [](const BenchmarkJob& job) { return measure_conflicts(non_ideal_machine(job.machine).gpu->srp); }};
}

}  // namespace tools
