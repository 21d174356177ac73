#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include "shader_kernels/graph.h"

namespace kernels {

std::string_view name_of(Op op);

/// Nodes of a graph by operation.
using OpCounts = std::array<std::uint32_t, static_cast<std::size_t>(Op::kCount)>;
OpCounts count_ops(const Graph& graph);

/// Operations a functional unit executes: all but inputs, constants and reinterpreted bits.
std::uint32_t executed_ops(const Graph& graph);

/// One line per operation kind that occurs, then one per load and store.
std::string summary(const Graph& graph);
/// One line per node.
std::string listing(const Graph& graph);

}  // namespace kernels
