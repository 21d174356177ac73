#pragma once
#include <cstdint>

#include "hw_models/srp/schedule.h"

namespace hw {

/// Stall cycles of a loop because of conflicting accesses to banks of local memory: `cycles` per `items` items, once
/// the pipeline is full.
struct BankConflicts {
  std::uint64_t cycles = 0;
  std::uint64_t items = 1;
  /// Returns the stall cycles of a loop of `items_in_loop` items.
  std::uint64_t stall_cycles(std::uint64_t items_in_loop) const { return cycles * items_in_loop / items; }
};

/// Computes the bank conflicts of a scheduled kernel in a local memory of `bank_count` banks, a power of two,
/// interleaved by 16 bytes.
///
/// 1. Arrays of records are staggered, as a compiler would place them: each begins a record's length after the one
/// before.
/// 2. The array of functional units is scheduled statically, so k accesses to one bank in a cycle take k - 1 extra
/// cycles.
/// 3. Items access records in item order; a constant index is the same record for all items.
///
/// Not modelled: prologue and drain, accesses of the T&I unit.
BankConflicts bank_conflicts(const KernelSchedule& schedule, const kernels::Graph& graph, std::uint32_t bank_count);

}  // namespace hw
