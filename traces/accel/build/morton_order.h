#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "traces/scene/bounds.h"

namespace traces {

/// Items sorted by the Morton codes of their boxes' centres; equal codes keep the input order.
struct MortonOrder {
  std::vector<std::uint32_t> items;  ///< input index of each item
  std::vector<std::uint64_t> codes;  ///< Morton code of each item, ascending
};

/// Returns the Morton code of grid cell (x, y, z): `bits` / 3 bits of each coordinate are interleaved, x highest.
std::uint64_t morton_code(std::uint32_t x, std::uint32_t y, std::uint32_t z, std::uint32_t bits);

/// Sorts boxes by the Morton codes of their centres on a cubic grid over all centres. `bits` per code: a multiple of 3
/// up to 63.
MortonOrder morton_order(std::span<const Bounds> boxes, std::uint32_t bits);

/// Sorts items by code with a stable radix sort: digits of 8 bits, the lowest first.
void sort_by_code(MortonOrder& order, std::uint32_t bits);

}  // namespace traces
