#include "hw_models/srp/schedule_units.h"

#include <algorithm>
#include <array>

namespace hw {
namespace {

std::uint32_t divided_up(std::uint32_t a, std::uint32_t b) { return (a + b - 1) / b; }

}  // namespace

Pool pool_of(OpClass c) {
  if (c == OpClass::kCachedRead) return Pool::kCache;
  return is_memory(c) ? Pool::kLocal : Pool::kArray;
}

std::uint32_t pool_size(Pool pool, const ArrayConfig& array) {
  switch (pool) {
    case Pool::kLocal:
      return array.local_ports;
    case Pool::kCache:
      return array.cache_ports;
    default:
      return array.units();
  }
}

std::uint32_t capable_units(OpClass c, const ArrayConfig& array) {
  if (c == OpClass::kFpDivSqrt) return array.div_sqrt_units;
  if (c == OpClass::kFpMul || c == OpClass::kFpMulAdd || c == OpClass::kIntMul) return array.mul_units;
  return pool_size(pool_of(c), array);
}

std::uint32_t resource_interval(const std::vector<Operation>& operations, const ArrayConfig& array) {
  struct Demand {
    std::uint32_t operations = 0, busy = 0, longest = 0;
  };
  std::array<Demand, kOpClasses> demands;
  for (const Operation& op : operations) {
    Demand& demand = demands[static_cast<std::size_t>(op.kind)];
    demand.operations += 1;
    demand.busy += op.occupancy;
    demand.longest = std::max(demand.longest, op.occupancy);
  }
  std::uint32_t ii = 1;
  for (std::size_t kind = 0; kind < demands.size(); ++kind) {
    const Demand& demand = demands[kind];
    if (demand.operations == 0) continue;
    // All operations that have no more units to go to than these have must share those.
    const auto own = static_cast<OpClass>(kind);
    const std::uint32_t units = capable_units(own, array);
    std::uint32_t busy = 0;
    for (std::size_t other = 0; other < demands.size(); ++other) {
      const auto c = static_cast<OpClass>(other);
      if (pool_of(c) == pool_of(own) && capable_units(c, array) <= units) busy += demands[other].busy;
    }
    ii = std::max({ii, divided_up(busy, units), divided_up(demand.operations, units) * demand.longest});
  }
  return ii;
}

}  // namespace hw
