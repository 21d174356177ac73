#pragma once
#include <bit>
#include <cassert>
#include <cstdint>

namespace hw {

/// A byte address in the GPU's memory image.
using Addr = std::uint64_t;

/// Bytes of a cache line, the unit of all caches, memory requests and the memory image. GpuConfig checks that all
/// caches have this line size.
inline constexpr Addr kLineBytes = 64;
/// Returns the address of the cache line that contains the byte at address `byte`.
constexpr Addr line_of(Addr byte) { return byte & ~(kLineBytes - 1); }
/// Returns a number of bytes rounded up to whole cache lines.
constexpr Addr round_up_to_lines(Addr bytes) { return line_of(bytes + kLineBytes - 1); }

/// Mask of the eight sectors of a cache line, one bit each; bit 0 is the first sector.
using SectorMask = std::uint8_t;
inline constexpr SectorMask kWholeLine = 0xff;
inline constexpr Addr kSectorBytes = kLineBytes / 8;

/// Identifies a tile in flight, for requests and events: the tile's number in the tile list, modulo a power of two
/// larger than the number of tiles in flight.
using TileTag = std::uint16_t;
inline constexpr TileTag kNoTile = 0xffff;
inline constexpr std::uint32_t kTileTagMask = 0x7fff;
/// Returns the number of the tile with tag `tag`, given the number of another tile in flight at the same time.
constexpr std::uint32_t tile_number_of_tag(TileTag tag, std::uint32_t other_tile_in_flight) {
  const std::uint32_t ahead = (tag - other_tile_in_flight) & kTileTagMask;
  return ahead <= kTileTagMask / 2 ? other_tile_in_flight + ahead : other_tile_in_flight + ahead - (kTileTagMask + 1);
}

/// Areas of memory that only the DMA accesses: the frame's regions, and space for spilled rays.
enum class Area : std::uint8_t { kPicture, kSamples, kRates, kSpill, kCount };

/// A request to read or write one cache line, or sectors of it.
struct MemRequest {
  Addr line = 0;             ///< address of the line's first byte
  std::uint16_t source = 0;  ///< the requester's index at the port, for the response
  std::uint16_t tag = 0;     ///< chosen by the requester, returned unchanged
  bool write = false;
  SectorMask sectors = kWholeLine;  ///< sectors to be read or written
  TileTag tile = kNoTile;
};

/// Response to a read request. Writes have no response.
struct MemResponse {
  Addr line = 0;
  std::uint16_t source = 0;
  std::uint16_t tag = 0;
};

/// Message to an L2 bank at the end of a frame: write all dirty lines to memory.
struct Flush {};

/// Interleaves cache lines over `count` L2 banks or DRAM channels: a field of address bits selects the bank or channel.
class Interleave {
 public:
  constexpr Interleave(std::uint64_t granule_bytes, std::uint32_t count)
      : shift_(static_cast<std::uint32_t>(std::countr_zero(granule_bytes))), mask_(count - 1) {
    assert(std::has_single_bit(granule_bytes) && std::has_single_bit(count));
  }
  constexpr std::uint32_t index_of(Addr line) const { return static_cast<std::uint32_t>(line >> shift_) & mask_; }

 private:
  std::uint32_t shift_;
  std::uint32_t mask_;
};

}  // namespace hw
