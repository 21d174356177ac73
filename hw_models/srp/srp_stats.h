#pragma once
#include <cstdint>

#include "hw_models/srp/schedule.h"

namespace hw {

/// What one kernel cost on one core.
struct KernelUse {
  std::uint64_t launches = 0;  ///< chunks, each with prologue and drain
  std::uint64_t items = 0;
  std::uint64_t cycles = 0;    ///< switch and stalls included
};

struct SrpStats {
  std::uint64_t tiles = 0, chunks = 0, switches = 0, rays = 0, hits = 0;
  static void describe(auto& s, auto&& counter) {
    counter(s.tiles, "tiles", "tiles taken");
    counter(s.chunks, "chunks", "chunks of launches run on the array");
    counter(s.switches, "switches", "kernel switches");
    counter(s.rays, "rays", "rays sent to the T&I unit", "tni.ray_route");
    counter(s.hits, "hits", "hits taken back", "tni.ray_route");
  }
};

}  // namespace hw
