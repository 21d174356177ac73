#pragma once
#include <array>
#include <cstdint>
#include <string>
#include <string_view>

#include "sim/unit_report.h"

namespace hw {

/// Blocks of the GPU for which energy and area are summed. Each class of unit declares its block as kBlock. `kOutside`
/// is not on the GPU's die and has neither energy nor area.
enum class Block : std::uint8_t { kTni, kSrp, kL2, kTileBuffer, kDma, kInterconnect, kDram, kRaster, kBuild, kOutside };
constexpr std::array<std::string_view, 10> names_of(Block) {
  return {"tni", "srp", "l2", "tile_buffer", "dma", "interconnect", "dram", "raster", "build", sim::kOutsideBlock};
}

/// Returns the name of a unit of a core: ("core.tni.trv", 1) -> "core1.tni.trv".
inline std::string unit_name_in_core(std::string_view unit_kind, std::uint32_t core_number) {
  constexpr std::string_view kCore = "core";
  return std::string(kCore).append(std::to_string(core_number)).append(unit_kind.substr(kCore.size()));
}

}  // namespace hw
