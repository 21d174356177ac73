#include "tools/tiles/lettering.h"

#include <algorithm>
#include <array>

namespace tools {
namespace {

/// Rows from above, five bits each.
struct Letter {
  char letter;
  std::uint64_t rows;
};
constexpr std::array<Letter, 40> kLetters = {{
    {'+', 0x0084f9080}, {'-', 0x0000f8000}, {'.', 0x00000018c}, {'0', 0x3a33ae62e}, {'1', 0x11842108e},
    {'2', 0x3a211111f}, {'3', 0x7c441062e}, {'4', 0x08ca97c42}, {'5', 0x7e1e0862e}, {'6', 0x1910f462e},
    {'7', 0x7c2222108}, {'8', 0x3a317462e}, {'9', 0x3a317844c}, {'A', 0x3a31fc631}, {'B', 0x7a31f463e},
    {'C', 0x3a308422e}, {'D', 0x72518c65c}, {'E', 0x7e10f421f}, {'F', 0x7e10f4210}, {'G', 0x3a30bc62f},
    {'H', 0x4631fc631}, {'I', 0x38842108e}, {'J', 0x1c4210a4c}, {'K', 0x4654c5251}, {'L', 0x42108421f},
    {'M', 0x4775ac631}, {'N', 0x4639ace31}, {'O', 0x3a318c62e}, {'P', 0x7a31f4210}, {'Q', 0x3a318d64d},
    {'R', 0x7a31f5251}, {'S', 0x3e107043e}, {'T', 0x7c8421084}, {'U', 0x46318c62e}, {'V', 0x46318c544},
    {'W', 0x4631ad6aa}, {'X', 0x462a22a31}, {'Y', 0x463151084}, {'Z', 0x7c222221f}, {'n', 0x0016cc631},
}};

}  // namespace

void Lettering::draw(std::string_view text, std::vector<std::uint8_t>& rgb, std::uint32_t row, std::uint32_t x,
                     std::uint32_t y) {
  constexpr std::uint32_t kColumns = 5;
  for (const char c : text) {
    const auto* const letter = std::ranges::find(kLetters, c, &Letter::letter);
    for (std::uint32_t i = 0; letter != kLetters.end() && i < kColumns * kHeight; ++i) {
      if ((letter->rows >> (kColumns * kHeight - 1 - i) & 1U) == 0) continue;
      const auto at = std::size_t{3} * (std::size_t{y + i / kColumns} * row + x + i % kColumns);
      std::fill_n(rgb.begin() + static_cast<std::ptrdiff_t>(at), 3, std::uint8_t{0});
    }
    x += kAdvance;
  }
}

}  // namespace tools
