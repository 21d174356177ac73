#pragma once
#include <cstdint>

namespace hw {

/// A byte address in the GPU's memory image.
using Addr = std::uint64_t;

/// Which eighths of a line: a bit each, the lowest for its first bytes.
using SectorMask = std::uint8_t;
inline constexpr SectorMask kWholeLine = 0xff;

/// A request for one cache line (or part of one) on its way to memory.
struct MemRequest {
  Addr line = 0;             ///< address of the line's first byte
  std::uint16_t source = 0;  ///< who asked: index of the requester's port, for the way back
  std::uint16_t tag = 0;     ///< the requester's own mark, returned unchanged
  bool write = false;
  SectorMask sectors = kWholeLine;  ///< what is written, or what is wanted
};

/// A line that came back. Writes are posted and have no response.
struct MemResponse {
  Addr line = 0;
  std::uint16_t source = 0;
  std::uint16_t tag = 0;
};

/// The frame is over: what is newer than memory must go there.
struct Flush {};

}  // namespace hw
