#include "traces/scene/exr_header.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <utility>

#include <fmt/format.h>

#include "sim/io/printable.h"

namespace traces {
namespace {

// The file begins with a magic number of four bytes, one byte of version and three bytes of flags.
constexpr std::size_t kFlags = 5, kHeader = 8;
constexpr int kTiledDeepOrParts = 0x02 | 0x08 | 0x10;

constexpr std::size_t kMostChannels = 4, kBytesOfChannel = 16;  // after its name
constexpr std::size_t kLongestName = 255;

// Attribute types of fixed size: the library reads that number of bytes, whatever size the header claims.
constexpr std::array<std::pair<std::string_view, std::size_t>, 9> kKinds = {{{"box2i", 16},
                                                                             {"chromaticities", 32},
                                                                             {"compression", 1},
                                                                             {"float", 4},
                                                                             {"int", 4},
                                                                             {"lineOrder", 1},
                                                                             {"rational", 8},
                                                                             {"timecode", 8},
                                                                             {"v2f", 8}}};

template <class T>
T number_at(std::string_view bytes, std::size_t at) {
  T number{};
  if (at + sizeof number <= bytes.size()) std::memcpy(&number, bytes.data() + at, sizeof number);
  return number;
}

/// Removes a zero-terminated text from the front of `rest`. Returns false if there is no zero.
bool take_text(std::string_view& rest, std::string_view& text) {
  const std::size_t end = rest.find('\0');
  if (end == std::string_view::npos) return false;
  text = rest.substr(0, end);
  rest.remove_prefix(end + 1);
  return true;
}

/// Returns the fault of a channel list, or an empty text.
std::string problem_of_channels(std::string_view list) {
  std::size_t channels = 0;
  std::string_view name;
  for (; take_text(list, name) && !name.empty() && name.size() <= kLongestName; ++channels) {
    list.remove_prefix(std::min(list.size(), kBytesOfChannel));
  }
  if (!name.empty() || !list.empty()) return "damaged: the list of channels";
  return channels > kMostChannels ? fmt::format("{} channels, allowed are 1 to {}", channels, kMostChannels) : "";
}

/// Returns the fault of an attribute whose type has another size or is not one that we write, or an empty text.
std::string problem_of_kind(std::string_view kind, std::size_t size) {
  if (kind == "string" || kind == "chlist") return {};
  const auto* found = std::ranges::find(kKinds, kind, &std::pair<std::string_view, std::size_t>::first);
  if (found == kKinds.end()) return fmt::format("an attribute of the kind '{}'", sim::printable(kind));
  return found->second == size ? "" : fmt::format("damaged: a {} of {} bytes", kind, size);
}

/// Returns the fault of a data window (two inclusive corners), or an empty text.
std::string problem_of_window(std::string_view box, std::uint64_t most_pixels) {
  const auto side = [&](std::size_t at) {
    return std::int64_t{number_at<std::int32_t>(box, at + 8)} - number_at<std::int32_t>(box, at) + 1;
  };
  const std::int64_t width = side(0), height = side(4);
  if (width < 1 || height < 1) return "the image has no pixels";
  const auto pixels = static_cast<std::uint64_t>(width) * static_cast<std::uint64_t>(height);
  return pixels > most_pixels ? fmt::format("{} x {} pixels, allowed are {}", width, height, most_pixels) : "";
}

}  // namespace

std::string exr_problem(std::string_view file, std::uint64_t most_pixels) {
  if (file.size() < kHeader) return "damaged: ends early";
  if ((file[kFlags] & kTiledDeepOrParts) != 0) return "tiled, deep or of several parts; allowed: one part of lines";
  std::string_view rest = file.substr(kHeader), name, kind;
  std::string problem;
  while (problem.empty()) {
    if (!take_text(rest, name)) return "damaged: ends early";
    if (name.empty()) break;
    if (!take_text(rest, kind) || rest.size() < sizeof(std::uint32_t)) return "damaged: ends early";
    const auto size = number_at<std::uint32_t>(rest, 0);
    rest.remove_prefix(sizeof size);
    if (size > rest.size()) return "damaged: an attribute is longer than the file";
    const std::string_view value = rest.substr(0, size);
    if (name.size() > kLongestName) return "damaged: a name without an end";
    problem = problem_of_kind(kind, size);
    if (kind == "chlist") problem = problem_of_channels(value);
    if (name == "dataWindow" && problem.empty()) problem = problem_of_window(value, most_pixels);
    rest.remove_prefix(size);
  }
  return problem;
}

}  // namespace traces
