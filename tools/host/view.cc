#include "tools/host/view.h"

#include <algorithm>
#include <array>
#include <cstdlib>
#include <string_view>

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <termios.h>
#include <unistd.h>

namespace tools {
namespace {

using Colour = std::array<std::uint8_t, 3>;

Colour colour_at(const SmallPicture& picture, std::size_t x, std::size_t y) {
  const std::uint8_t* at = picture.rgb.data() + 3 * (y * picture.width + x);
  return {at[0], at[1], at[2]};
}

/// The terminal that the process belongs to, which neither echoes nor waits for a line's end while this is there.
class RawTerminal {
 public:
  RawTerminal() : file_(::open("/dev/tty", O_RDWR | O_NOCTTY | O_CLOEXEC)) {
    if (file_ < 0) return;
    is_raw_ = ::tcgetpgrp(file_) == ::getpgrp() && ::tcgetattr(file_, &before_) == 0;
    if (!is_raw_) return;
    termios raw = before_;
    raw.c_lflag &= ~static_cast<tcflag_t>(ICANON | ECHO);
    ::tcsetattr(file_, TCSANOW, &raw);
  }
  ~RawTerminal() {
    if (is_raw_) ::tcsetattr(file_, TCSANOW, &before_);
    if (file_ >= 0) ::close(file_);
  }
  RawTerminal(const RawTerminal&) = delete;
  RawTerminal& operator=(const RawTerminal&) = delete;

  /// The answer up to its last character; what has come by then if that takes too long.
  std::string ask(std::string_view question, char last) const {
    constexpr int kPatienceMs = 200;
    constexpr std::size_t kLongest = 256;
    std::string answer;
    if (!is_raw_ || ::write(file_, question.data(), question.size()) < 0) return answer;
    for (pollfd in{file_, POLLIN, 0}; answer.size() < kLongest && ::poll(&in, 1, kPatienceMs) == 1;) {
      char c = 0;
      if (::read(file_, &c, 1) != 1) break;
      answer += c;
      if (c == last) break;
    }
    return answer;
  }

 private:
  const int file_;
  bool is_raw_ = false;
  termios before_{};
};

constexpr unsigned kLevels = 6;   ///< levels of each channel, in sixels
constexpr std::size_t kBand = 6;  ///< rows of a line of sixels

unsigned sixel_colour(const Colour& c) {
  const auto level = [](std::uint8_t value) { return (value * (kLevels - 1) + 127U) / 255; };
  return (level(c[0]) * kLevels + level(c[1])) * kLevels + level(c[2]);
}

/// One colour of a band: a character for each column, runs of them shortened.
void add_runs(std::string& out, const std::vector<std::uint8_t>& bits) {
  for (std::size_t x = 0; x < bits.size();) {
    std::size_t end = x;
    while (end < bits.size() && bits[end] == bits[x]) ++end;
    const char sixel = static_cast<char>('?' + bits[x]);
    out += end - x > 3 ? fmt::format("!{}{}", end - x, sixel) : std::string(end - x, sixel);
    x = end;
  }
}

void add_band(std::string& out, const SmallPicture& picture, std::size_t top) {
  std::array<bool, kLevels * kLevels * kLevels> used{};
  const std::size_t rows = std::min(kBand, picture.height - top);
  std::vector<unsigned> colours(rows * picture.width);
  for (std::size_t i = 0; i < colours.size(); ++i) {
    colours[i] = sixel_colour(colour_at(picture, i % picture.width, top + i / picture.width));
    used[colours[i]] = true;
  }
  std::vector<std::uint8_t> bits(picture.width);
  for (unsigned colour = 0; colour < used.size(); ++colour) {
    if (!used[colour]) continue;
    std::ranges::fill(bits, 0);
    for (std::size_t i = 0; i < colours.size(); ++i) {
      if (colours[i] == colour) bits[i % picture.width] |= static_cast<std::uint8_t>(1U << (i / picture.width));
    }
    out += fmt::format("#{}", colour);
    add_runs(out, bits);
    out += '$';
  }
  out += '-';
}

}  // namespace

Graphics graphics_of_terminal() {
  // "ESC [ ? 62 ; 4 ; 22 c": 4 stands for sixels.
  const std::string answer = RawTerminal().ask("\x1b[c", 'c');
  if (answer.find(";4;") != std::string::npos || answer.ends_with(";4c")) return Graphics::kSixel;
  const char* colours = std::getenv("COLORTERM");
  const std::string_view says = colours == nullptr ? "" : colours;
  return says == "truecolor" || says == "24bit" ? Graphics::kHalfBlocks : Graphics::kNone;
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

std::string sixels(const SmallPicture& picture) {
  std::string out = fmt::format("\x1bPq\"1;1;{};{}", picture.width, picture.height);
  for (unsigned colour = 0; colour < kLevels * kLevels * kLevels; ++colour) {
    constexpr unsigned kPercent = 100 / (kLevels - 1);
    out += fmt::format("#{};2;{};{};{}", colour, kPercent * (colour / kLevels / kLevels),
                       kPercent * (colour / kLevels % kLevels), kPercent * (colour % kLevels));
  }
  for (std::size_t top = 0; top < picture.height; top += kBand) add_band(out, picture, top);
  return out + "\x1b\\";
}

}  // namespace tools
