#include "hw_models/srp/schedule_units.h"

#include <algorithm>

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
  std::uint32_t ii = 1;
  for (const Operation& op : operations) {
    // All operations that have no more units to go to than this one has must share those.
    const std::uint32_t units = capable_units(op.kind, array);
    std::uint32_t busy = 0, alike = 0;
    for (const Operation& other : operations) {
      if (pool_of(other.kind) != pool_of(op.kind) || capable_units(other.kind, array) > units) continue;
      busy += other.occupancy;
      alike += other.kind == op.kind ? 1 : 0;
    }
    ii = std::max({ii, divided_up(busy, units), divided_up(alike, units) * op.occupancy});
  }
  return ii;
}

}  // namespace hw
