#pragma once
#include <cstddef>
#include <cstdint>
#include <vector>

#include "hw_models/srp/op_table.h"
#include "hw_models/srp/schedule_graph.h"
#include "hw_models/srp/srp_config.h"

namespace hw {

/// Functional units of one kind; not every unit of a pool can take every operation.
enum class Pool : std::uint8_t { kArray, kLocal, kCache, kCount };
inline constexpr std::size_t kPools = static_cast<std::size_t>(Pool::kCount);

Pool pool_of(OpClass c);
std::uint32_t pool_size(Pool pool, const ArrayConfig& array);
/// How many units of its pool, from the first on, can take such an operation.
std::uint32_t capable_units(OpClass c, const ArrayConfig& array);
/// The least interval at which every operation finds a unit.
std::uint32_t resource_interval(const std::vector<Operation>& operations, const ArrayConfig& array);

}  // namespace hw
