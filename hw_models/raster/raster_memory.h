#pragma once
#include <cstdint>

#include "hw_models/memory/messages.h"
#include "traces/stream.h"

namespace hw {

/// Arrays of a rasteriser in memory, one behind the other, each on lines of its own.
struct RasterMemory {
  static constexpr std::uint32_t kPositionBytes = 12;     ///< a vertex as the scene has it: three floats
  static constexpr std::uint32_t kIndexBytes = 12;        ///< a triangle: the numbers of its vertices
  static constexpr std::uint32_t kTransformedBytes = 16;  ///< a vertex in the picture: four floats
  static constexpr std::uint32_t kEntryBytes = 4;         ///< an entry of a list: the number of a triangle

  Addr positions = 0, indices = 0, transformed = 0, lists = 0, end = 0;

  RasterMemory() = default;
  RasterMemory(Addr base, const traces::RasterDemands& demands) : positions(base) {
    indices = whole_lines(positions + Addr{demands.vertices} * kPositionBytes);
    transformed = whole_lines(indices + Addr{demands.triangles} * kIndexBytes);
    lists = whole_lines(transformed + Addr{demands.vertices} * kTransformedBytes);
    end = whole_lines(lists + Addr{demands.entries} * kEntryBytes);
  }
  Addr position_at(std::uint32_t vertex) const { return positions + Addr{vertex} * kPositionBytes; }
  Addr index_at(std::uint32_t triangle) const { return indices + Addr{triangle} * kIndexBytes; }
  Addr transformed_at(std::uint32_t vertex) const { return transformed + Addr{vertex} * kTransformedBytes; }
  Addr entry_at(std::uint32_t entry) const { return lists + Addr{entry} * kEntryBytes; }
};

}  // namespace hw
