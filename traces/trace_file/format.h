#pragma once
#include <algorithm>
#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <utility>

#include "sim/io/json.h"
#include "traces/trace_file/tile_code.h"

namespace traces {

// A trace is a file with streams of work (docs/trace-format.md).
//
//   magic | header | trees and parts: tiles, sizes of tiles | contents | footer
//
// Each block between magic and footer is a zstd frame. A part is one frame of the picture, rendered by one program.

using sim::Json;

inline constexpr std::string_view kTraceMagic = "raywatt-trace/5\n";
/// Magics of former versions that can still be read, with their numbers: 4 has no wide trees, 3 no rasterisers.
inline constexpr std::array<std::pair<std::string_view, int>, 2> kFormerMagics{
    {{"raywatt-trace/4\n", 4}, {"raywatt-trace/3\n", 3}}};
inline constexpr std::string_view kTraceKind = "raywatt-trace/";  ///< start of the magic of all versions
inline constexpr int kTraceVersion = 5;
inline constexpr std::string_view kTraceEnd = "end\n";
inline constexpr std::size_t kFooterBytes = 16;  ///< offset of the contents (8 bytes), their size (4), kTraceEnd (4)

/// Largest unpacked size of each kind of block in a trace. The contents are mostly two numbers per tile, 17 to 22
/// bytes: 23 MB for a frame of 16384 x 16384 pixels in tiles of 16 x 16. Once read, the contents take up to 20 times
/// that memory.
inline constexpr std::uint64_t kMaxHeaderBytes = 1U << 24, kMaxContentsBytes = 1U << 26,
                               kMaxTreeBytes = std::uint64_t{1} << 31;
inline constexpr std::uint32_t kMaxPartTiles = 1U << 26, kMaxFrame = 1'000'000;

/// Returns the largest encoded size of a tile: 64 KiB per sample, and 32 bytes per triangle of a tree to be built. Real
/// tiles need 100 to 500 bytes per sample, real trees 8 bytes per triangle.
constexpr std::uint64_t most_tile_bytes(const FrameRequirements& requirements) {
  const std::uint64_t built = requirements.build ? std::uint64_t{32} * requirements.build->triangles : 0;
  return std::min<std::uint64_t>(kMaxTileBytes,
                                 (1U << 16) + (std::uint64_t{1} << 16) * requirements.tile_samples + built);
}

inline constexpr std::uint64_t kMaxSmallBlock = 1U << 18, kMaxPacking = 64;
/// Returns the largest unpacked size that a block of `packed` bytes in a trace may have. The limit keeps the memory
/// that a small file can demand within 30 times its blocks' contents. Only highly repetitive data would pack better.
constexpr std::uint64_t most_unpacked_bytes(std::uint64_t packed) {
  return std::max(kMaxSmallBlock, kMaxPacking * packed);
}

/// Returns an integer from JSON that is at most `most`. Throws InputError, without a file name, for anything else.
std::uint64_t number_of(const Json& json, std::uint64_t most, const char* what);
std::uint64_t number_at(const Json& json, const char* key, std::uint64_t most);

Json to_json(const ImageCounts& counts);
Json to_json(const FrameRequirements& requirements);
/// Reads the sizes of a scene from JSON. Throws InputError, without a file name, for counts that no scene has, and
/// JsonError for missing ones.
ImageCounts counts_of_json(const Json& json);
FrameRequirements requirements_of_json(const Json& json);

}  // namespace traces
