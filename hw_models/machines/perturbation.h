#pragma once
#include <cstdint>
#include <vector>

#include "hw_models/dram/dram_shift.h"

namespace hw {

/// Displacements that no architect would notice, but that make a frame another draw of the races in it: cores start
/// some cycles apart, the memory's fabric is a cycle of its command clock longer or shorter, refreshes come at another
/// phase. After Alameldeen and Wood, "Variability in Architectural Simulations of Multi-threaded Workloads", HPCA 2003
/// (docs/noise.md). None by default.
struct Perturbation {
  std::vector<std::uint32_t> starts;  ///< cycles of the tile dispatcher before a core gets its first tile; empty: none
  DramShift dram;
};

/// Draws the perturbation of a replicate of a frame; replicate 0 has none.
Perturbation draw_perturbation(std::uint32_t cores, std::uint32_t frame, std::uint32_t replicate);

}  // namespace hw
