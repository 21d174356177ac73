#pragma once
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace tools {

/// A picture for a terminal: 8 bits a channel, row by row; empty while there is none.
struct SmallPicture {
  std::size_t width = 0, height = 0;
  std::vector<std::uint8_t> rgb;
  bool empty() const { return rgb.empty(); }
};

/// Live figures and picture of a running job, read by the thread that draws the progress.
class View {
 public:
  virtual ~View() = default;
  /// Returns the figures, one line of text each.
  virtual std::vector<std::string> lines() = 0;
  /// Returns the picture so far, at most `width` x `height` pixels.
  virtual SmallPicture picture(std::size_t width, std::size_t height) = 0;
};

/// True if COLORTERM is `truecolor` or `24bit`: the terminal shows 24-bit colour.
bool has_true_colour();

/// Draws a picture in half blocks: two pixels per character, one above the other, in 24-bit colour.
std::string half_blocks(const SmallPicture& picture);

}  // namespace tools
