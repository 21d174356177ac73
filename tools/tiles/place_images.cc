#include "tools/tiles/place_images.h"

#include <algorithm>
#include <array>

#include <fmt/format.h>

#include "sim/config/config.h"

namespace tools {
namespace {

/// Whole numbers up to this are exact in 16 bits.
constexpr std::uint32_t kMostHalf = 2048;

}  // namespace

std::vector<traces::ImageNote> notes_of(const Inputs& inputs, const kernels::ProgramSpec& program) {
  return {{"raywatt:config_hash", sim::config_hash(inputs.config)},
          {"raywatt:scene", inputs.scene.name},
          {"raywatt:scene_sha256", inputs.scene_sha256},
          {"raywatt:program", program.name()},
          {"raywatt:frame", std::to_string(inputs.frame)}};
}

void write_pixels(const std::filesystem::path& file, const std::vector<kernels::PixelWork>& pixels, std::uint32_t width,
                  std::uint32_t height, std::span<const traces::ImageNote> notes) {
  using kernels::PixelWork;
  constexpr std::array kFigures = {&PixelWork::rays, &PixelWork::steps, &PixelWork::tests};
  std::vector<traces::ImageChannel> channels = {{"rays"}, {"steps"}, {"tests"}};
  for (std::size_t c = 0; c < channels.size(); ++c) {
    const auto fits = [&](const PixelWork& pixel) { return pixel.*kFigures[c] <= kMostHalf; };
    channels[c].is_half = std::ranges::all_of(pixels, fits);
  }
  std::vector<float> values;
  values.reserve(pixels.size() * channels.size());
  for (const PixelWork& pixel : pixels) {
    for (const auto figure : kFigures) values.push_back(static_cast<float>(pixel.*figure));
  }
  traces::write_exr(file, width, height, channels, values, notes);
}

void write_heat_maps(const std::filesystem::path& folder, const std::string& prefix, const std::vector<HeatMap>& maps,
                     std::span<const traces::ImageNote> notes) {
  for (const HeatMap& map : maps) {
    const DrawnMap drawn = draw(map);
    const std::string name = fmt::format("{}debug-{}", prefix, map.name);
    traces::write_png(folder / (name + ".png"), drawn.width, drawn.height, drawn.rgb, notes);
    const std::vector<traces::ImageChannel> channel = {{map.name}};
    traces::write_exr(folder / (name + ".exr"), map.width, map.height, channel, map.values, notes);
  }
}

}  // namespace tools
