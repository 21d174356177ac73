#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "tools/run/frame/run_job.h"
#include "tools/tiles/tile_table.h"

namespace tools {

/// A figure over the picture, one value per pixel.
struct HeatMap {
  std::string name;   ///< "steps"
  std::string title;  ///< "Traversal steps of a pixel"
  const char* map;    ///< OpenImageIO's name of the colour map
  std::uint32_t width = 0, height = 0;
  std::vector<float> values;
};

/// Returns the heat maps of an itemised frame, summed over all passes; none for a replay, which has no picture.
///   `cycles`: of the pixel's tile, from dispatch to end
///   `srp-cycles`: of the pixel's tile, on the array of its shader core
///   `rays`, `steps`, `tests`: of the pixel
///   `energy`: nominal energy of the pixel's tile, shared equally by its pixels
std::vector<HeatMap> heat_maps(const FrameResult& s, const TileFrame& tiles, std::uint32_t width, std::uint32_t height);

/// A heat map in colours from 0 to the largest value, above a colour bar with a label.
struct DrawnMap {
  std::uint32_t width = 0, height = 0;
  std::vector<std::uint8_t> rgb;
};
DrawnMap draw(const HeatMap& map);

}  // namespace tools
