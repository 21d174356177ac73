#pragma once
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "tools/tiles/heat_map.h"
#include "traces/scene/images.h"

namespace tools {

inline constexpr const char* kPixelsFile = "pixels.exr";

/// Notes with which an image of a run says where it comes from: configuration hash, scene, program, frame.
std::vector<traces::ImageNote> notes_of(const Inputs& inputs, const kernels::ProgramSpec& program);

/// Writes the file of what each pixel took: channels `rays`, `steps` and `tests`, each in 16 bits if that is exact for
/// all its values, else in 32.
void write_pixels(const std::filesystem::path& file, const std::vector<kernels::PixelWork>& pixels, std::uint32_t width,
                  std::uint32_t height, std::span<const traces::ImageNote> notes);

/// Writes each as PREFIXdebug-NAME.png, with a bar, and as .exr, whose one channel has the values.
void write_heat_maps(const std::filesystem::path& folder, const std::string& prefix, const std::vector<HeatMap>& maps,
                     std::span<const traces::ImageNote> notes);

}  // namespace tools
