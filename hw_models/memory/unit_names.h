#pragma once
#include <array>
#include <cstdint>
#include <string>
#include <string_view>

namespace hw {

/// Blocks of the GPU by which energy is summed. Each unit declares its block as kBlock.
enum class Block : std::uint8_t { kTni, kSrp, kL2, kTileBuffer, kDma, kInterconnect, kDram, kRaster };
constexpr std::array<std::string_view, 8> names_of(Block) {
  return {"tni", "srp", "l2", "tile_buffer", "dma", "interconnect", "dram", "raster"};
}

/// Returns the name of a unit of a core: ("core.tni.trv", 1) -> "core1.tni.trv".
inline std::string name_in_core(std::string_view unit_kind, std::uint32_t core_number) {
  constexpr std::string_view kCore = "core";
  return std::string(kCore).append(std::to_string(core_number)).append(unit_kind.substr(kCore.size()));
}

}  // namespace hw
