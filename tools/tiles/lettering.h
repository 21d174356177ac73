#pragma once
#include <cstdint>
#include <string_view>
#include <vector>

namespace tools {

/// Text on a picture: digits and capitals of five by seven pixels, the same wherever a host keeps its fonts.
struct Lettering {
  static constexpr std::uint32_t kHeight = 7, kAdvance = 6;
  static constexpr std::uint32_t width(std::string_view text) {
    return static_cast<std::uint32_t>(text.size()) * kAdvance;
  }
  /// In black; (x, y) is its upper left pixel. What it has no letter for is left blank.
  static void draw(std::string_view text, std::vector<std::uint8_t>& rgb, std::uint32_t row, std::uint32_t x,
                   std::uint32_t y);
};

}  // namespace tools
