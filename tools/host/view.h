#pragma once
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace tools {

/// A picture to be shown on a terminal, 8 bits a channel, row by row; empty: none yet.
struct SmallPicture {
  std::size_t width = 0, height = 0;
  std::vector<std::uint8_t> rgb;
  bool empty() const { return rgb.empty(); }
};

/// Figures and picture of a job while it runs, shown beside how far it is. Asked by the thread that shows them.
class View {
 public:
  virtual ~View() = default;
  /// Figures, a line of text each.
  virtual std::vector<std::string> lines() = 0;
  /// The picture so far, of at most that many pixels a side.
  virtual SmallPicture picture(std::size_t width, std::size_t height) = 0;
};

/// Ways in which a terminal shows pictures.
enum class Graphics : std::uint8_t { kNone, kHalfBlocks, kSixel };

/// Asks the terminal what it can: sixels if it answers so when asked (primary device attributes), half blocks in 24-bit
/// colour if COLORTERM says so.
Graphics graphics_of_terminal();

/// Two pixels a character, one above the other, a line for each two rows of the picture.
std::string half_blocks(const SmallPicture& picture);
/// The picture in the sixel format, in 216 colours.
std::string sixels(const SmallPicture& picture);

}  // namespace tools
