#include "tools/host/view.h"

#include <array>
#include <cstdlib>
#include <string_view>

#include <fmt/format.h>

namespace tools {
namespace {

using Colour = std::array<std::uint8_t, 3>;

Colour colour_at(const SmallPicture& picture, std::size_t x, std::size_t y) {
  const std::uint8_t* at = picture.rgb.data() + 3 * (y * picture.width + x);
  return {at[0], at[1], at[2]};
}

}  // namespace

bool has_true_colour() {
  const char* variable = std::getenv("COLORTERM");
  const std::string_view value = variable == nullptr ? "" : variable;
  return value == "truecolor" || value == "24bit";
}

std::string half_blocks(const SmallPicture& picture) {
  std::string out;
  for (std::size_t y = 0; y < picture.height; y += 2) {
    out += '\r';
    for (std::size_t x = 0; x < picture.width; ++x) {
      const Colour up = colour_at(picture, x, y);
      const Colour down = y + 1 < picture.height ? colour_at(picture, x, y + 1) : Colour{};
      out += fmt::format("\x1b[38;2;{};{};{};48;2;{};{};{}m\u2580", up[0], up[1], up[2], down[0], down[1], down[2]);
    }
    out += "\x1b[0m\x1b[K\n";
  }
  return out;
}

}  // namespace tools
