#pragma once
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "tools/tiles/heat_map.h"
#include "traces/scene/images.h"

namespace tools {

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
