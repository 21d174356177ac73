#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "hw_models/srp/op_table.h"
#include "hw_models/srp/srp_config.h"
#include "shader_kernels/graph.h"

namespace hw {

/// Cycle and unit at which the schedule places one operation, or one access of a load or store.
struct Placement {
  std::uint32_t node = 0;   ///< node of the kernel's graph
  std::uint32_t part = 0;   ///< index of the part of a record that the access moves; a part is as wide as the port
  std::uint32_t start = 0;  ///< cycle of issue, counted from the item's first cycle
  std::uint32_t unit = 0;   ///< number of the functional unit (row by row), local port or cache port
};

/// A kernel scheduled as a software-pipelined loop on the shader core's array. Item i of n starts at cycle i * ii and
/// ends `depth` cycles later, so a loop takes depth + (n - 1) * ii cycles. All counts are per item.
struct KernelSchedule {
  std::string kernel;
  std::uint32_t ii = 1;       ///< initiation interval in cycles
  std::uint32_t depth = 0;    ///< cycles from the start to the end of one item
  std::uint32_t res_mii = 1;  ///< lower bound of the interval by units and ports
  std::uint32_t rec_mii = 0;  ///< lower bound of the interval by values passed from item to item; 0 without such values
  OpMix ops{};
  std::uint32_t fu_ops = 0;        ///< operations on functional units
  std::uint32_t local_reads = 0;   ///< 16-byte accesses
  std::uint32_t local_writes = 0;  ///< 16-byte accesses
  std::uint32_t cached_loads = 0;  ///< records
  std::uint32_t queued_loads = 0;  ///< accesses to the data cache that wait in the load queue
  std::uint32_t rf_reads = 0;      ///< one per operand
  std::uint32_t rf_writes = 0;     ///< one per result and per loaded word
  std::uint32_t route_hops = 0;    ///< one per operand that another unit or port produced
  std::uint32_t config_reads = 0;  ///< one word per functional unit and cycle of the interval
  std::vector<Placement> placements;
};

/// Places a kernel's operations on the shader core's array at the smallest initiation interval that it finds, by
/// iterative modulo scheduling (B. R. Rau, MICRO-27, 1994). Deterministic.
///
///   graph --> [ operations and 16-byte accesses ] --> bounds --> [ reservation table of ii rows ] --> schedule
///
/// 1. Memory ports are separate from the array and occupy no functional unit.
/// 2. Records are loaded and stored whole; their accesses are placed one by one.
///
/// Not modelled: limits of the routing network (an operand costs one hop wherever it comes from), register pressure,
/// records that two items in flight both change, VLIW mode.
KernelSchedule schedule_kernel(const kernels::Graph& graph, const SrpConfig& config);

}  // namespace hw
