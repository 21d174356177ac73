#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "hw_models/srp/op_table.h"
#include "hw_models/srp/srp_config.h"
#include "shader_kernels/graph.h"

namespace hw {

/// Cycle and unit that a kernel's schedule assigns to one operation, or to one access of a load or store.
struct Placement {
  std::uint32_t node = 0;   ///< number of the operation's node in the kernel's graph
  std::uint32_t part = 0;   ///< which port-wide part of a record the access moves
  std::uint32_t start = 0;  ///< cycle in which the operation is issued, from the start of the loop item
  std::uint32_t unit = 0;   ///< number of the functional unit (row by row), local port or cache port
};

/// A kernel scheduled as a software-pipelined loop on the shader core's array. Item i starts at cycle i * ii and ends
/// `depth` cycles later, so a loop of n items takes depth + (n - 1) * ii cycles. All counts are per item.
struct KernelSchedule {
  std::string kernel;
  std::uint32_t ii = 1;       ///< initiation interval: cycles from the start of one item to the start of the next
  std::uint32_t depth = 0;    ///< cycles from the start to the end of one item
  std::uint32_t res_mii = 1;  ///< lower bound of the initiation interval from the number of units and ports
  std::uint32_t rec_mii = 0;  ///< lower bound of the initiation interval from values passed between items; 0: none
  OpMix ops{};
  std::uint32_t fu_ops = 0;        ///< number of operations on functional units
  std::uint32_t local_reads = 0;   ///< 16-byte reads of local memory
  std::uint32_t local_writes = 0;  ///< 16-byte writes to local memory
  std::uint32_t cached_loads = 0;  ///< records loaded through the data cache
  std::uint32_t queued_loads = 0;  ///< data cache accesses that go through the load queue
  std::uint32_t rf_reads = 0;      ///< register file reads: one per operand
  std::uint32_t rf_writes = 0;     ///< register file writes: one per result and per loaded word
  std::uint32_t route_hops = 0;    ///< hops in the routing network: one per operand that another unit or port produced
  std::uint32_t config_reads = 0;  ///< configuration words read: one per functional unit and cycle of the interval
  std::vector<Placement> placements;
};

/// Schedules a kernel on the shader core's array by iterative modulo scheduling (B. R. Rau, MICRO-27, 1994), at the
/// smallest initiation interval found. Deterministic.
///
///   graph --> [ operations and 16-byte accesses ] --> bounds --> [ reservation table of ii rows ] --> schedule
///
/// 1. Memory ports are separate from the array and occupy no functional unit.
/// 2. A record is loaded or stored as a whole, by several accesses that are placed independently.
///
/// Not modelled: limits of the routing network (every operand costs one hop), register pressure, records that two items
/// in flight both change, VLIW mode.
KernelSchedule schedule_kernel(const kernels::Graph& graph, const SrpConfig& config);

/// Stalls of a kernel's loop for bank conflicts in local memory. With a full pipeline, every `items` items cost
/// `cycles` stall cycles.
struct BankConflicts {
  std::uint64_t cycles = 0;
  std::uint64_t items = 1;
  /// Returns the cycles for which bank conflicts stall a loop of `items_in_loop` items.
  std::uint64_t stall_cycles(std::uint64_t items_in_loop) const { return cycles * items_in_loop / items; }
};

/// Computes the bank conflicts of a scheduled kernel in a local memory of `bank_count` banks, a power of two,
/// interleaved by 16 bytes.
///
/// 1. Arrays of records begin in staggered banks, as a compiler would place them: each array begins in the bank after
/// the first record of the previous array.
/// 2. The functional units are scheduled statically, so k accesses to one bank in a cycle stall all of them for k - 1
/// cycles.
/// 3. Item i accesses record i. An access with a constant index goes to the same record for all items.
///
/// Not modelled: prologue and drain of a loop, accesses of the T&I unit.
BankConflicts bank_conflicts(const KernelSchedule& schedule, const kernels::Graph& graph, std::uint32_t bank_count);

}  // namespace hw
