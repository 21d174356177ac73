#pragma once
#include <bit>
#include <cassert>
#include <cstdint>

namespace hw {

/// A byte address in the GPU's memory image.
using Addr = std::uint64_t;

/// Bytes of a line, the unit of caches, requests and the memory image. GpuConfig checks that all caches have this line
/// size.
inline constexpr Addr kLineBytes = 64;
/// Returns the address of the line that contains the byte.
constexpr Addr line_of(Addr byte) { return byte & ~(kLineBytes - 1); }
/// Returns the bytes rounded up to whole lines.
constexpr Addr whole_lines(Addr bytes) { return line_of(bytes + kLineBytes - 1); }

/// Sectors of a line (its eighths), a bit each; the lowest bit is the first sector.
using SectorMask = std::uint8_t;
inline constexpr SectorMask kWholeLine = 0xff;
inline constexpr Addr kSectorBytes = kLineBytes / 8;

/// Tag of the tile that causes a request or event: its number in the tile list, modulo a power of two above the tiles
/// in flight.
using TileTag = std::uint16_t;
inline constexpr TileTag kNoTile = 0xffff;
inline constexpr std::uint32_t kTileTagMask = 0x7fff;
/// Returns the number of the tile with this tag, given the number of another tile in flight at the same time.
constexpr std::uint32_t tile_number_near(TileTag tag, std::uint32_t other) {
  const std::uint32_t ahead = (tag - other) & kTileTagMask;
  return ahead <= kTileTagMask / 2 ? other + ahead : other + ahead - (kTileTagMask + 1);
}

/// Parts of memory that only the DMA accesses: the frame's regions, and room for spilled ray slots.
enum class Area : std::uint8_t { kPicture, kSamples, kRates, kSpill, kCount };

/// A request to read or write one cache line, or part of one.
struct MemRequest {
  Addr line = 0;             ///< address of the line's first byte
  std::uint16_t source = 0;  ///< the requester's index at the port, for the response
  std::uint16_t tag = 0;     ///< chosen by the requester, returned unchanged
  bool write = false;
  SectorMask sectors = kWholeLine;  ///< sectors to be written or read
  TileTag tile = kNoTile;
};

/// Response to a read. Writes are posted and have no response.
struct MemResponse {
  Addr line = 0;
  std::uint16_t source = 0;
  std::uint16_t tag = 0;
};

/// Message at the end of a frame: write all dirty lines to memory.
struct Flush {};

/// Interleaving of lines over `count` L2 banks or DRAM channels. A field of address bits selects the bank or channel.
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
