#pragma once
#include <string>

#include "tools/studies/report/run/run_parts.h"

namespace tools::pages {

/// Numbers over the picture, as its block has them: of tiles, each {id, name, tile, unit, values, low, high}, and of
/// pixels, each {id, name, pixels, step, unit, low, high, scale}.
struct Overlays {
  Json grids = Json::array();
  std::uint64_t pixel_bytes = 0;  ///< data: URLs of those of pixels
  Json times;                     ///< times of tiles: {side, begin_us, end_us, core}; null if not known
  std::string missing;            ///< why there are none of tiles or of pixels; empty if there are
};

/// Pixels of an overlay; of a larger picture squares are averaged.
inline constexpr std::size_t kMostPixels = 1 << 19;

/// Those of the first frame: tiles.json and pixels.exr beside the report, and what the report says of an adaptive
/// frame.
Overlays overlays_of(const Run& run);

}  // namespace tools::pages
