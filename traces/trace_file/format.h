#pragma once
#include <algorithm>
#include <array>
#include <cstdint>
#include <string>
#include <string_view>

#include "sim/io/json.h"
#include "traces/trace_file/tile_code.h"

namespace traces {

// A trace: streams of work on disk (docs/trace-format.md).
//
//   magic | header | trees and parts: tiles, sizes of tiles | contents | footer
//
// Each block between magic and footer is a zstd frame. A part is a frame of the picture, as one frame program renders
// it.

using sim::Json;

inline constexpr std::string_view kTraceMagic = "raywatt-trace/4\n";
inline constexpr std::string_view kFormerMagic = "raywatt-trace/3\n";  ///< the same without rasterisers: read, too
inline constexpr std::string_view kTraceKind = "raywatt-trace/";       ///< begins files of any version
inline constexpr int kTraceVersion = 4;
inline constexpr std::string_view kTraceEnd = "end\n";
inline constexpr std::size_t kFooterBytes = 16;  ///< offset of the contents (8), their bytes (4), kTraceEnd

/// Largest blocks, unpacked. Most of the contents are two figures a tile, 17 to 22 bytes: 23 MB for a frame of
/// 16384 x 16384 pixels in tiles of 16 x 16. What is read takes up to 20 times that memory.
inline constexpr std::uint64_t kMaxHeaderBytes = 1U << 24, kMaxContentsBytes = 1U << 26,
                               kMaxTreeBytes = std::uint64_t{1} << 31;
inline constexpr std::uint32_t kMaxPartTiles = 1U << 26, kMaxFrame = 1'000'000;

/// The most bytes that the work of a tile may take: 64 KiB for a sample, of which real ones need 100 to 500.
constexpr std::uint64_t most_tile_bytes(const FrameRequirements& requirements) {
  return std::min<std::uint64_t>(kMaxTileBytes, (1U << 16) + (std::uint64_t{1} << 16) * requirements.tile_samples);
}

/// The most bytes that a block may hold, by those that it takes: a small file takes little memory, which is up to 30
/// times what its blocks hold. Only what repeats itself over and over packs better.
inline constexpr std::uint64_t kMaxSmallBlock = 1U << 18, kMaxPacking = 64;
constexpr std::uint64_t most_held(std::uint64_t packed) { return std::max(kMaxSmallBlock, kMaxPacking * packed); }

/// A whole number of the contents, at most `most`; InputError, without the file's name, otherwise.
std::uint64_t number_of(const Json& json, std::uint64_t most, const char* what);
std::uint64_t number_at(const Json& json, const char* key, std::uint64_t most);

Json to_json(const ImageCounts& counts);
Json to_json(const FrameRequirements& requirements);
/// InputError, without the file's name, for what no scene has; JsonError for what is not there.
ImageCounts counts_of_json(const Json& json);
FrameRequirements requirements_of_json(const Json& json);

}  // namespace traces
