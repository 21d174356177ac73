#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "tools/run/frame/run_job.h"
#include "tools/tiles/tile_table.h"

namespace tools {

/// A figure over the picture, a value to a pixel.
struct HeatMap {
  std::string name;   ///< "steps"
  std::string title;  ///< "Traversal steps of a pixel"
  const char* map;    ///< OpenImageIO's name of its colours
  std::uint32_t width = 0, height = 0;
  std::vector<float> values;
};

/// Those of a frame that was itemised; of all passes together. None of a replay, which has no picture.
///   `cycles`, `srp-cycles`: of a pixel's tile, from dispatch to end; of these, on the array of its shader core
///   `rays`, `steps`, `tests`: of the pixel
///   `energy`: nominal, of its tile, shared evenly by its pixels
std::vector<HeatMap> heat_maps(const FrameResult& s, const TileFrame& tiles, std::uint32_t width, std::uint32_t height);

/// A heat map as people look at it: colours from nothing to the largest value, and below them a bar that says so.
struct DrawnMap {
  std::uint32_t width = 0, height = 0;
  std::vector<std::uint8_t> rgb;
};
DrawnMap draw(const HeatMap& map);

}  // namespace tools
