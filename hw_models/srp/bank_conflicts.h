#pragma once
#include <cstdint>

#include "hw_models/srp/schedule.h"

namespace hw {

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
