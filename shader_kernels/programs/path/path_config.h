#pragma once
#include <cstdint>

#include "sim/config/field.h"
#include "sim/named.h"

namespace kernels {

/// Configuration keys of the program path:N. All of them change the recorded work.
struct PathConfig {
  std::uint32_t roulette_start = 2;
  double roulette_least = 0.05;

  static void describe(auto& c, auto&& field) {
    using sim::Affects;
    field(NAMED(c.roulette_start), "bounces",
          "first bounce after which a path survives only by Russian roulette, with its largest throughput as "
          "probability",
          sim::between(1, 16), Affects::kFunction);
    field(NAMED(c.roulette_least), "", "smallest probability with which a path survives Russian roulette",
          sim::between(0.001, 1), Affects::kFunction);
  }
};

}  // namespace kernels
