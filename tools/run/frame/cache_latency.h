#pragma once
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "sim/config/field.h"
#include "sim/named.h"

namespace tools {

struct RunConfig;

/// Hit latency over the size of a cache: one file of configs/latency.
struct LatencyConfig {
  std::string process = "unnamed";
  std::map<std::string, sim::Band> arrays;
  std::uint32_t l1 = 1, l2 = 11;

  static void describe(auto& c, auto&& field) {
    using sim::Affects;
    field(NAMED(c.process), "", "what the figures describe", sim::any(), Affects::kReport);
    field(NAMED(c.arrays), "ns", "time in which an array is read, as read@16KiB: points of a curve over its size",
          sim::at_least(0), Affects::kTiming);
    field(NAMED(c.l1), "cycles", "of a hit of a first-level cache of the T&I unit, beside its array",
          sim::between(0, 63), Affects::kTiming);
    field(NAMED(c.l2), "cycles", "of a hit of the L2, beside its array", sim::between(0, 63), Affects::kTiming);
  }
};

/// Sets the hit latency of caches with hit_cycles `auto` from size and clock. InputError without a curve.
void set_hit_cycles(RunConfig& config);

/// Returns a warning for each cache with hit_cycles `auto` and a size outside the curve.
std::vector<std::string> latency_warnings(const RunConfig& config);

}  // namespace tools
