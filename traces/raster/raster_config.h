#pragma once
#include <cstdint>

#include "sim/config/field.h"
#include "sim/named.h"

namespace traces {

/// Configuration keys of the rasteriser: sizes of a batch of triangles and of a block of pixels.
struct RasterConfig {
  std::uint32_t batch = 1024;
  std::uint32_t block = 8;

  static void describe(auto& c, auto&& field) {
    using sim::Affects;
    field(NAMED(c.batch), "triangles", "triangles that a core puts into lists at a time, in the geometry pass",
          sim::between(1, 1 << 20), Affects::kFunction);
    field(NAMED(c.block), "pixels",
          "side of a block of pixels, the unit of coarse coverage and of the hierarchical z buffer",
          sim::power_of_two(2, 64), Affects::kFunction);
  }
};

}  // namespace traces
