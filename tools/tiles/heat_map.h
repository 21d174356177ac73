#pragma once
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "tools/run/frame/run_job.h"
#include "tools/tiles/tile_table.h"
#include "traces/scene/images.h"

namespace tools {

/// Heat map of one metric, with a value for each pixel of the picture.
struct HeatMap {
  std::string name;   ///< name in the file name: "steps"
  std::string title;  ///< title above the map: "Traversal steps of a pixel"
  const char* map;    ///< OpenImageIO's name of the colour map
  std::uint32_t width = 0, height = 0;
  std::vector<float> values;
};

/// Returns the heat maps of a frame with itemised costs, summed over all passes; none for a replay, which has no
/// picture.
/// - `cycles`: T&I cycles of the pixel's tile, from dispatch to end
/// - `srp-cycles`: cycles of the pixel's tile on the array of its shader core
/// - `rays`, `steps`, `tests`: counts of the pixel
/// - `energy`: nominal energy of the pixel's tile, shared equally by its pixels
std::vector<HeatMap> heat_maps(const FrameResult& s, const TileFrame& tiles, std::uint32_t width, std::uint32_t height);

/// A heat map in colours from 0 to the largest value, above a colour bar with a label.
struct DrawnMap {
  std::uint32_t width = 0, height = 0;
  std::vector<std::uint8_t> rgb;
};
DrawnMap draw_heat_map(const HeatMap& map);

inline constexpr const char* kPixelsFile = "pixels.exr";

/// Returns the notes that identify a run in its images: configuration hash, scene, program, frame.
std::vector<traces::ImageNote> notes_of(const Inputs& inputs, const kernels::ProgramSpec& program);

/// Writes the work of each pixel: channels `rays`, `steps` and `tests`, each in 16 bits if that is exact for all its
/// values, otherwise in 32.
void write_pixels(const std::filesystem::path& file, const std::vector<kernels::PixelWork>& pixels, std::uint32_t width,
                  std::uint32_t height, std::span<const traces::ImageNote> notes);

/// Writes each map as PREFIXdebug-NAME.png with a colour bar, and its values as the only channel of a .exr.
void write_heat_maps(const std::filesystem::path& folder, const std::string& prefix, const std::vector<HeatMap>& maps,
                     std::span<const traces::ImageNote> notes);

}  // namespace tools
