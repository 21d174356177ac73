#pragma once
#include <bit>
#include <cassert>
#include <cstdint>

namespace hw {

/// A byte address in the GPU's memory image.
using Addr = std::uint64_t;

/// Bytes of a line: what caches keep, what a request asks for, and what the memory image is laid out in. GpuConfig
/// holds every cache to it.
inline constexpr Addr kLineBytes = 64;
/// The line that holds the byte, by the address of its first.
constexpr Addr line_of(Addr byte) { return byte & ~(kLineBytes - 1); }
/// Bytes, rounded up to whole lines.
constexpr Addr whole_lines(Addr bytes) { return line_of(bytes + kLineBytes - 1); }

/// Sectors, the eighths of a line: a bit each, the lowest for its first bytes.
using SectorMask = std::uint8_t;
inline constexpr SectorMask kWholeLine = 0xff;
inline constexpr Addr kSectorBytes = kLineBytes / 8;

/// Tag of the tile for which something is done: its number in the tile list, modulo more tiles than can be in flight.
using TileTag = std::uint16_t;
inline constexpr TileTag kNoTile = 0xffff;
inline constexpr std::uint32_t kTileTagMask = 0x7fff;
/// Returns the number of the tile with that tag, given that of another tile in flight at the same time.
constexpr std::uint32_t tile_number_near(TileTag tag, std::uint32_t other) {
  const std::uint32_t ahead = (tag - other) & kTileTagMask;
  return ahead <= kTileTagMask / 2 ? other + ahead : other + ahead - (kTileTagMask + 1);
}

/// Parts of memory that only the DMA reads and writes: the regions of the frame, and room for ray slots.
enum class Area : std::uint8_t { kPicture, kSamples, kRates, kSpill, kCount };

/// A request for one cache line (or part of one) on its way to memory.
struct MemRequest {
  Addr line = 0;             ///< address of the line's first byte
  std::uint16_t source = 0;  ///< index of the requester's port, for the way back
  std::uint16_t tag = 0;     ///< the requester's own mark, returned unchanged
  bool write = false;
  SectorMask sectors = kWholeLine;  ///< sectors that are written, or wanted
  TileTag owner = kNoTile;
};

/// A line that came back. Writes are posted and have no response.
struct MemResponse {
  Addr line = 0;
  std::uint16_t source = 0;
  std::uint16_t tag = 0;
};

/// The frame is over: what is newer than memory must go there.
struct Flush {};

/// Interleaving of lines over `count` equal neighbours (L2 banks, DRAM channels): a field of address bits names the
/// owner.
class Interleave {
 public:
  constexpr Interleave(std::uint64_t granule_bytes, std::uint32_t count)
      : shift_(static_cast<std::uint32_t>(std::countr_zero(granule_bytes))), mask_(count - 1) {
    assert(std::has_single_bit(granule_bytes) && std::has_single_bit(count));
  }
  constexpr std::uint32_t owner(Addr line) const { return static_cast<std::uint32_t>(line >> shift_) & mask_; }

 private:
  std::uint32_t shift_;
  std::uint32_t mask_;
};

}  // namespace hw
