#pragma once
#include <cstdint>

#include "sim/config/field.h"
#include "sim/named.h"

namespace traces {

/// Largest distance of a vertex from the origin. Squares and products of two such coordinates are finite floats.
inline constexpr double kFarthest = 1e15;

/// Sizes of the largest scene that is accepted. A larger one is refused before memory is allocated.
struct SceneLimits {
  sim::ByteSize memory{std::uint64_t{1} << 33};
  std::uint64_t pixels = std::uint64_t{1} << 27;
  std::uint32_t json_depth = 128;
  std::uint32_t nodes = 100'000;

  static void describe(auto& c, auto&& field) {
    using enum sim::Affects;
    field(NAMED(c.memory), "bytes", "largest size of a scene's files, decoded and laid out for the GPU",
          sim::at_least(1 << 20), kFunction);
    field(NAMED(c.pixels), "pixels", "most pixels of all images together; 134217728 is 32 times 2048 x 2048",
          sim::at_least(1), kFunction);
    field(NAMED(c.json_depth), "levels", "deepest nesting of a glTF file's JSON", sim::between(8, 1000), kFunction);
    field(NAMED(c.nodes), "nodes", "most nodes of a glTF file, and most entries of any other list of the file",
          sim::at_least(1), kFunction);
  }
};

}  // namespace traces
