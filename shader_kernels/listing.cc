#include "shader_kernels/listing.h"

#include <bit>

#include <fmt/format.h>

namespace kernels {
namespace {

constexpr std::array<std::string_view, static_cast<std::size_t>(Op::kCount)> kNames = {
    "input",     "constant", "add",        "sub",         "mul",     "div",        "sqrt",        "min",
    "max",       "abs",      "neg",        "floor",       "int_add", "int_sub",    "int_mul",     "and",
    "or",        "xor",      "shift_left", "shift_right", "less",    "less_equal", "equal",       "int_less",
    "int_equal", "select",   "to_float",   "to_int",      "bits",    "load_local", "store_local", "load_cached"};

bool is_memory(Op op) { return op == Op::kLoadLocal || op == Op::kStoreLocal || op == Op::kLoadCached; }

std::string operands(const GraphNode& node) {
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

std::uint32_t executed_ops(const Graph& graph) {
  std::uint32_t ops = 0;
  for (const GraphNode& node : graph.nodes) {
    ops += node.op != Op::kInput && node.op != Op::kConstant && node.op != Op::kBits ? 1U : 0U;
  }
  return ops;
}

std::string summary(const Graph& graph) {
  std::string text = fmt::format("{}: {} operations\n", graph.kernel, executed_ops(graph));
  const OpCounts counts = count_ops(graph);
  for (std::size_t op = 0; op < counts.size(); ++op) {
    if (counts[op] != 0) text += fmt::format("  {:<12}{:>5}\n", kNames[op], counts[op]);
  }
  for (const GraphNode& node : graph.nodes) {
    if (is_memory(node.op)) text += fmt::format("  {:<12}{:>5} bytes  {}\n", name_of(node.op), node.bytes, node.label);
  }
  return text;
}

std::string listing(const Graph& graph) {
  std::string text;
  for (std::size_t i = 0; i < graph.nodes.size(); ++i) {
    text += fmt::format("%{:<4} {:<12}{}\n", i, name_of(graph.nodes[i].op), operands(graph.nodes[i]));
  }
  return text;
}

}  // namespace kernels
