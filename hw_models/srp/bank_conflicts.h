#pragma once
#include <cstdint>

#include "hw_models/srp/schedule.h"

namespace hw {

/// Cycles for which a loop stands still because accesses of one cycle want the same bank of local memory: `cycles` in
/// every run of `items` items, once the loop is full.
struct BankConflicts {
  std::uint64_t cycles = 0;
  std::uint64_t items = 1;
  /// Over a loop of `n` items.
  std::uint64_t of(std::uint64_t n) const { return cycles * n / items; }
};

/// Local memory lies in `banks` banks (a power of two), 16 bytes of each in turn. The arrays of records that a kernel
/// uses are staggered, as its compiler would place them: each begins a record's length behind the one before.
/// The array is scheduled statically, so a cycle in which k accesses meet in a bank takes k - 1 cycles more.
/// Records are taken to be read and written in the order of the items, which is how streams are made; a constant index
/// is the same record for all. Not modelled: prologue and drain, and the T&I unit's own accesses.
BankConflicts bank_conflicts(const KernelSchedule& schedule, const kernels::Graph& graph, std::uint32_t banks);

}  // namespace hw
