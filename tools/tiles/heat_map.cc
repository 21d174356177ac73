#include "tools/tiles/heat_map.h"

#include <algorithm>
#include <array>
#include <map>
#include <utility>

#include <fmt/format.h>

#include "sim/config/config.h"
#include "traces/scene/images.h"

namespace tools {
namespace {

/// Rectangle of the picture that a tile renders, and a metric's sum over all passes of the frame.
struct Area {
  std::uint32_t x = 0, y = 0, width = 0, height = 0;
  double sum = 0;
};

/// Returns the sum of a metric over all passes for each area of the picture. A tile in a later pass counts for the area
/// of the same tile in the first pass.
std::vector<Area> sum_by_area(const TileFrame& tiles, auto&& value) {
  const auto whole = [&](const char* column, std::size_t i) { return static_cast<std::uint32_t>(tiles.at(column)[i]); };
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::size_t> index;
  std::vector<Area> areas;
  for (std::size_t i = 0; i < tiles.rows(); ++i) {
    const auto [known, is_new] = index.try_emplace({whole("x", i), whole("y", i)}, areas.size());
    if (is_new) areas.push_back({whole("x", i), whole("y", i), whole("width", i), whole("height", i)});
    areas[known->second].sum += value(i);
  }
  return areas;
}

HeatMap tile_heat_map(HeatMap map, const std::vector<Area>& areas, bool shared) {
  map.values.resize(std::size_t{map.width} * map.height);
  for (const Area& area : areas) {
    const double pixels = std::max(1.0, static_cast<double>(area.width) * area.height);
    const auto value = static_cast<float>(shared ? area.sum / pixels : area.sum);
    for (std::uint32_t y = area.y; y < area.y + area.height; ++y) {
      std::fill_n(map.values.begin() + std::ptrdiff_t{y} * map.width + area.x, area.width, value);
    }
  }
  return map;
}

HeatMap pixel_heat_map(HeatMap map, const std::vector<kernels::PixelWork>& pixels,
                       std::uint32_t kernels::PixelWork::*figure) {
  for (const kernels::PixelWork& pixel : pixels) map.values.push_back(static_cast<float>(pixel.*figure));
  return map;
}

}  // namespace

std::vector<HeatMap> heat_maps(const FrameResult& s, const TileFrame& tiles, std::uint32_t width,
                               std::uint32_t height) {
  if (tiles.find("x") == nullptr) return {};
  const std::vector<double>&begin = tiles.at("dispatched"), &end = tiles.at("finished");
  const auto cycles = [&](std::size_t i) { return end[i] - begin[i]; };
  const auto srp_cycles = [&](std::size_t i) { return tiles.at("srp_cycles")[i]; };
  constexpr double kNanojoulesPerMillijoule = 1e6;
  const auto energy = [&](std::size_t i) { return tiles.at("energy_mj_nominal")[i] * kNanojoulesPerMillijoule; };
  using kernels::PixelWork;
  const std::vector<PixelWork>& pixels = s.rendered.pixels;
  const auto map = [&](const char* name, const char* title, const char* colours) {
    return HeatMap{name, title, colours, width, height, {}};
  };
  return {tile_heat_map(map("cycles", "Cycles of a tile", "turbo"), sum_by_area(tiles, cycles), false),
          tile_heat_map(map("srp-cycles", "SRP cycles of a tile", "turbo"), sum_by_area(tiles, srp_cycles), false),
          pixel_heat_map(map("rays", "Rays of a pixel", "viridis"), pixels, &PixelWork::rays),
          pixel_heat_map(map("steps", "Traversal steps of a pixel", "viridis"), pixels, &PixelWork::steps),
          pixel_heat_map(map("tests", "Triangle tests of a pixel", "viridis"), pixels, &PixelWork::tests),
          tile_heat_map(map("energy", "Energy of a pixel in nJ", "turbo"), sum_by_area(tiles, energy), true)};
}

DrawnMap draw_heat_map(const HeatMap& map) {
  constexpr std::uint32_t kMargin = 3, kBar = 8;
  const float most = *std::ranges::max_element(map.values);
  const std::string most_text = most < 1000 ? fmt::format("{:.4g}", most) : fmt::format("{:.0f}", most);
  const std::string text = fmt::format("{}: 0 to {}", map.title, most > 0 ? most_text : "0");
  const traces::GreyImage label = traces::draw_text(text);
  DrawnMap out{std::max(map.width, label.width + 2 * kMargin), 0, {}};
  out.height = map.height + kBar + label.height + 3 * kMargin;
  std::vector<float> shares;
  shares.reserve(map.values.size() + out.width);
  for (const float value : map.values) shares.push_back(most > 0 ? value / most : 0);
  const std::uint32_t steps = std::max(1U, out.width - 2 * kMargin - 1);
  for (std::uint32_t i = 0; i <= steps; ++i) shares.push_back(static_cast<float>(i) / static_cast<float>(steps));
  const std::vector<std::uint8_t> colours = traces::apply_colour_map(map.map, shares);
  out.rgb.assign(std::size_t{3} * out.width * out.height, 255);
  const auto at = [&](std::uint32_t x, std::uint32_t y) {
    return out.rgb.begin() + 3 * (std::ptrdiff_t{y} * out.width + x);
  };
  for (std::uint32_t y = 0; y < map.height; ++y) {
    std::copy_n(colours.begin() + 3 * std::ptrdiff_t{y} * map.width, std::size_t{3} * map.width, at(0, y));
  }
  const auto bar = colours.begin() + 3 * static_cast<std::ptrdiff_t>(map.values.size());
  for (std::uint32_t y = 0; y < kBar; ++y)
    std::copy_n(bar, std::size_t{3} * (steps + 1), at(kMargin, map.height + kMargin + y));
  for (std::uint32_t y = 0; y < label.height; ++y) {
    auto to = at(kMargin, map.height + kBar + 2 * kMargin + y);
    for (std::uint32_t x = 0; x < label.width; ++x) {
      to = std::fill_n(to, 3, label.pixels[std::size_t{y} * label.width + x]);
    }
  }
  return out;
}

namespace {

/// Largest number up to which 16-bit floats represent all whole numbers exactly.
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
    const DrawnMap drawn = draw_heat_map(map);
    const std::string name = fmt::format("{}debug-{}", prefix, map.name);
    traces::write_png(folder / (name + ".png"), drawn.width, drawn.height, drawn.rgb, notes);
    const std::vector<traces::ImageChannel> channel = {{map.name}};
    traces::write_exr(folder / (name + ".exr"), map.width, map.height, channel, map.values, notes);
  }
}

}  // namespace tools
