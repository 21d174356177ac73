#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include "shader_kernels/graph.h"

namespace kernels {

std::string_view name_of(Op op);

/// Number of a graph's nodes per operation.
using OpCounts = std::array<std::uint32_t, static_cast<std::size_t>(Op::kCount)>;
OpCounts count_ops(const Graph& graph);

/// Returns the number of operations executed by functional units: all except inputs, constants and kBits.
std::uint32_t executed_ops(const Graph& graph);

/// Returns one line per operation that occurs, then one per load and store.
std::string summary(const Graph& graph);
/// Returns one line per node.
std::string listing(const Graph& graph);

}  // namespace kernels
