#pragma once
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "traces/accel/memory_image.h"
#include "traces/stream.h"
#include "traces/trace_file/bytes.h"

namespace traces {

// Encoding of the memory accesses of a launch. A shape is the list of access kinds of an item. First come the shapes of
// the launch; then, if there are several, the shape of each item; then each access, as the difference to the tile's
// previous access of the same kind and rank (first, second, ... of its kind within the item).

/// Largest number of shapes (lists of access kinds) of a launch, and of accesses of an item.
inline constexpr std::uint32_t kMaxShapes = 4096, kMaxItemAccesses = 64;
inline constexpr std::size_t kAccessKinds = 8;
static_assert(static_cast<std::size_t>(Access::Kind::kStored) + 1 == kAccessKinds);

/// The tile's previous access of each kind and rank: rank k is the kth access of its kind within an item.
struct LastAccesses {
  std::array<std::array<Access, kMaxItemAccesses>, kAccessKinds> of{};
};

/// Encodes the memory accesses of a tile, launch by launch.
class AccessWriter {
 public:
  /// Forgets the accesses of the previous tile. Call before a tile's first launch.
  void begin_tile() { last_ = {}; }
  void write_launch(const TileWork& work, const WorkNode& launch, std::string& out);

 private:
  void write_access(const Access& access, std::uint32_t rank, ByteWriter& to);

  LastAccesses last_;
  std::vector<std::vector<std::uint8_t>> shapes_;
  std::vector<std::uint32_t> shape_of_;  ///< for each item, the number of its shape
};

/// Numbers of records and words that accesses of a frame can read.
struct AccessLimits {
  const ImageCounts& counts;
  std::uint64_t stored_words = 0;  ///< 4-byte words of region kSamples
};

/// Decodes the memory accesses that AccessWriter has encoded.
class AccessReader {
 public:
  void begin_tile() { last_ = {}; }
  /// Decodes and appends a launch's accesses, for `items` items. Throws InputError if they are missing or exceed
  /// `limits`.
  void read_launch(ByteReader& from, const AccessLimits& limits, std::uint32_t items, TileWork& work);

 private:
  void read_shapes(ByteReader& from);
  Access read_access(ByteReader& from, const AccessLimits& limits, std::uint32_t kind, std::uint32_t rank);

  LastAccesses last_;
  std::vector<std::uint8_t> kinds_, ranks_;  ///< kind and rank of each access of all shapes, one shape after the other
  std::vector<std::uint32_t> shape_begin_;   ///< for each shape, its first index in `kinds_`; then the end
  std::vector<std::uint32_t> shape_of_;
};

}  // namespace traces
