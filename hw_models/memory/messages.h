#pragma once
#include <array>
#include <bit>
#include <cassert>
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "sim/time.h"

namespace hw {

/// A byte address in the GPU's memory image.
using Addr = std::uint64_t;

/// Bytes of a cache line, which is the unit of memory requests. GpuConfig checks that all caches have this size.
inline constexpr Addr kLineBytes = 64;
/// Returns the address of the cache line that contains the byte at address `byte`.
constexpr Addr line_of(Addr byte) { return byte & ~(kLineBytes - 1); }
/// Returns a number of bytes rounded up to whole cache lines.
constexpr Addr round_up_to_lines(Addr bytes) { return line_of(bytes + kLineBytes - 1); }

/// Mask of the eight sectors of a cache line, one bit each; bit 0 is the first sector.
using SectorMask = std::uint8_t;
inline constexpr SectorMask kWholeLine = 0xff;
inline constexpr Addr kSectorBytes = kLineBytes / 8;

/// Identifies a tile in flight in requests and events. The tag is the tile's number in the tile list, modulo 2^15,
/// which is more than the tiles in flight.
using TileTag = std::uint16_t;
inline constexpr TileTag kNoTile = 0xffff;
inline constexpr std::uint32_t kTileTagMask = 0x7fff;
/// Converts a tile tag to the number of the tile in the tile list, given the number of any other tile in flight.
constexpr std::uint32_t tile_number_of_tag(TileTag tag, std::uint32_t other_tile_in_flight) {
  const std::uint32_t ahead = (tag - other_tile_in_flight) & kTileTagMask;
  return ahead <= kTileTagMask / 2 ? other_tile_in_flight + ahead : other_tile_in_flight + ahead - (kTileTagMask + 1);
}

/// Areas of memory that the DMA engines access: the frame's regions, and space for spilled rays.
enum class Area : std::uint8_t { kPicture, kSamples, kRates, kBuild, kTree, kSpill, kCount };

/// A request to memory or the L2 to read or write one cache line, or some sectors of a line.
struct MemRequest {
  Addr line = 0;             ///< address of the first byte of the requested line
  std::uint16_t source = 0;  ///< client number of the requester at the port, copied to the response
  std::uint16_t tag = 0;     ///< value chosen by the requester, copied to the response
  bool write = false;
  SectorMask sectors = kWholeLine;  ///< sectors of the line to be read or written
  TileTag tile = kNoTile;
};

/// Response to a MemRequest that reads. Writes get no response.
struct MemResponse {
  Addr line = 0;
  std::uint16_t source = 0;
  std::uint16_t tag = 0;
};

/// Message at the end of a frame. An L2 bank then writes all its dirty lines to memory; a background source stops.
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

/// Order in which an arbiter serves several requesters of one resource.
enum class Arbitration : std::uint8_t {
  kRoundRobin,   ///< round robin: each requester is served in turn
  kOldestFirst,  ///< the requester that has waited longest is served, the lowest number among equals
  kFixed,        ///< the ready requester with the lowest number is served, so others can starve
};
constexpr std::array<std::string_view, 3> names_of(Arbitration) { return {"round_robin", "oldest_first", "fixed"}; }

/// Decides which of up to 64 requesters of a shared resource is served next.
class Arbiter {
 public:
  Arbiter(Arbitration arbitration, std::size_t count)
      : arbitration_(arbitration), count_(static_cast<std::uint32_t>(count)) {
    assert(count <= 64);
  }

  std::uint32_t requester_count() const { return count_; }

  /// Returns the requester to serve next, among those of the mask `requester_mask` that are ready; requester_count() if
  /// there is none. is_ready(i): requester i can be served. waiting_since(i): time since which it waits.
  template <class Ready, class Since>
  std::uint32_t choose_requester(std::uint64_t requester_mask, Ready&& is_ready, Since&& waiting_since) const {
    if (arbitration_ == Arbitration::kOldestFirst) return oldest_ready(requester_mask, is_ready, waiting_since);
    for (std::uint64_t left = std::rotr(requester_mask, static_cast<int>(turn_)); left != 0; left &= left - 1) {
      const std::uint32_t i = (static_cast<std::uint32_t>(std::countr_zero(left)) + turn_) % 64;
      if (is_ready(i)) return i;
    }
    return count_;
  }
  /// Updates the round-robin order of the arbiter after `requester` has been served.
  void note_served(std::uint32_t requester) {
    if (arbitration_ == Arbitration::kRoundRobin) turn_ = next_index(requester);
  }

 private:
  std::uint32_t next_index(std::uint32_t i) const { return i + 1 == count_ ? 0 : i + 1; }
  template <class Ready, class Since>
  std::uint32_t oldest_ready(std::uint64_t requester_mask, Ready&& is_ready, Since&& waiting_since) const {
    std::uint32_t found = count_;
    sim::Time first = sim::kNever;
    for (std::uint64_t left = requester_mask; left != 0; left &= left - 1) {
      const auto i = static_cast<std::uint32_t>(std::countr_zero(left));
      if (waiting_since(i) >= first || !is_ready(i)) continue;
      found = i;
      first = waiting_since(i);
    }
    return found;
  }

  Arbitration arbitration_;
  std::uint32_t count_;
  std::uint32_t turn_ = 0;
};

}  // namespace hw
