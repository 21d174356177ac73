#pragma once
#include <array>
#include <cstdint>
#include <string_view>

#include "sim/config/field.h"
#include "sim/named.h"

namespace kernels {

/// Source of the samples of a tile's neighbours.
enum class Halo : std::uint8_t { kReload, kRetrace };
constexpr std::array<std::string_view, 2> names_of(Halo) { return {"reload", "retrace"}; }

/// Memory that holds samples' attributes between the kernel that writes them and the one that compares them.
enum class AttributeStorage : std::uint8_t { kTile, kDram };
constexpr std::array<std::string_view, 2> names_of(AttributeStorage) { return {"tile", "dram"}; }

/// Keys that every adaptive method has.
struct AdaptiveConfig {
  Halo halo = Halo::kReload;
  AttributeStorage attributes = AttributeStorage::kTile;

  static void describe(auto& c, auto&& field) {
    field(NAMED(c.halo), "",
          "samples of neighbouring tiles: read back from memory when those tiles have written them, or traced again",
          sim::any(), sim::Affects::kFunction);
    field(NAMED(c.attributes), "",
          "where a tile's attributes wait for their check: in the tile buffer, or written to memory and read back",
          sim::any(), sim::Affects::kFunction);
  }
};

}  // namespace kernels
