#pragma once
#include <cstdint>

namespace traces {

/// No vertex is further from the origin: in single precision, squares and products of two such coordinates are finite.
inline constexpr double kFarthest = 1e15;

/// What a scene may cost at most. A file that asks for more is refused before the memory is taken.
struct SceneLimits {
  std::uint64_t memory_bytes = std::uint64_t{1} << 33;  ///< everything read, decoded and later laid out for the GPU
  std::uint64_t pixels = std::uint64_t{1} << 26;        ///< of one image: 8192 x 8192
  std::uint32_t json_depth = 128;                       ///< nesting of a glTF file's JSON
  std::uint32_t nodes = 1'000'000;                      ///< of the hierarchy, and entries of any other list of the file
};

}  // namespace traces
