#pragma once
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "traces/accel/memory_image.h"
#include "traces/stream.h"
#include "traces/trace_file/bytes.h"

namespace traces {

// The accesses of a launch's items: first the shapes that items have, lists of kinds; then, where there are several,
// each item's shape; then what is accessed, as differences to the last access of that kind and rank (first, second, ...
// of its kind in the item) of the tile.

/// Shapes of a launch, and accesses of an item, at most.
inline constexpr std::uint32_t kMaxShapes = 4096, kMaxItemAccesses = 64;
inline constexpr std::size_t kAccessKinds = 7;
static_assert(static_cast<std::size_t>(Access::Kind::kInstance) + 1 == kAccessKinds);

/// Last access, by kind and rank.
struct LastAccesses {
  std::array<std::array<Access, kMaxItemAccesses>, kAccessKinds> of{};
};

/// Appends accesses, launch by launch.
class AccessWriter {
 public:
  /// Before a tile's first launch.
  void begin_tile() { last_ = {}; }
  void write(const TileWork& work, const WorkNode& launch, std::string& out);

 private:
  void write_access(const Access& access, std::uint32_t rank, ByteWriter& to);

  LastAccesses last_;
  std::vector<std::vector<std::uint8_t>> shapes_;
  std::vector<std::uint32_t> shape_of_;  ///< shape of each item
};

/// Reads them back.
class AccessReader {
 public:
  void begin_tile() { last_ = {}; }
  /// Appends the accesses of a launch of `items` items. InputError if they are not there, or not within `counts`.
  void read(ByteReader& from, const ImageCounts& counts, std::uint32_t items, TileWork& work);

 private:
  void read_shapes(ByteReader& from);
  Access read_access(ByteReader& from, const ImageCounts& counts, std::uint32_t kind, std::uint32_t rank);

  LastAccesses last_;
  std::vector<std::uint8_t> kinds_, ranks_;  ///< all shapes', one behind the other
  std::vector<std::uint32_t> shape_begin_;   ///< and one past the last
  std::vector<std::uint32_t> shape_of_;
};

}  // namespace traces
