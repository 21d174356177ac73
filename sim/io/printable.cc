#include "sim/io/printable.h"

#include <algorithm>
#include <cstdint>

#include <fmt/format.h>

namespace sim {
namespace {

/// Returns the number of bytes of the UTF-8 character at the start of `text`; 0 for control characters and bytes that
/// are not UTF-8.
std::size_t character_size(std::string_view text) {
  const auto first = static_cast<std::uint8_t>(text.front());
  if (first < 0x80) return first < 0x20 || first == 0x7f ? 0 : 1;
  const std::size_t size = first < 0xc2 ? 0 : first < 0xe0 ? 2 : first < 0xf0 ? 3 : first < 0xf5 ? 4 : 0;
  if (size == 0 || size > text.size()) return 0;
  const bool whole = std::ranges::all_of(text.substr(1, size - 1), [](char c) { return (c & 0xc0) == 0x80; });
  const auto second = static_cast<std::uint8_t>(text[1]);
  const bool too_long = (first == 0xe0 && second < 0xa0) || (first == 0xf0 && second < 0x90);
  const bool no_character = (first == 0xed && second > 0x9f) || (first == 0xf4 && second > 0x8f);
  const bool control = first == 0xc2 && second < 0xa0;
  return whole && !too_long && !no_character && !control ? size : 0;
}

}  // namespace

std::string printable(std::string_view text, std::size_t max_bytes) {
  std::string line;
  while (!text.empty()) {
    const std::size_t size = character_size(text);
    if (line.size() + std::max<std::size_t>(size, 1) > max_bytes) return line + "...";
    line.append(size == 0 ? "?" : text.substr(0, size));
    text.remove_prefix(std::max<std::size_t>(size, 1));
  }
  return line;
}

std::string with_escaped_bytes(std::string_view text) {
  std::string out;
  while (!text.empty()) {
    const auto first = static_cast<std::uint8_t>(text.front());
    const std::size_t size = first < 0x80 ? 1 : character_size(text);
    if (size == 0) {
      out += fmt::format("\\x{:02x}", first);
    } else {
      out += text.substr(0, size);
    }
    text.remove_prefix(std::max<std::size_t>(size, 1));
  }
  return out;
}

}  // namespace sim
