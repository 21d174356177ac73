#include "tools/run/frame/job_options.h"

#include <algorithm>
#include <charconv>

#include <fmt/format.h>

#include "sim/error.h"
#include "sim/io/printable.h"
#include "traces/scene/did_you_mean.h"

namespace tools {

Resolution parse_resolution(const std::string& text) {
  Resolution r;
  const char* end = text.data() + text.size();
  const auto [cross, bad_width] = std::from_chars(text.data(), end, r.width);
  const bool crossed = bad_width == std::errc{} && cross != end && *cross == 'x';
  const auto [rest, bad_height] =
      crossed ? std::from_chars(cross + 1, end, r.height) : std::from_chars_result{end, std::errc::invalid_argument};
  const auto sane = [](std::uint32_t n) { return n >= 1 && n <= 16384; };
  if (bad_height != std::errc{} || rest != end || !sane(r.width) || !sane(r.height)) {
    throw sim::InputError(fmt::format("--resolution '{}' is not WIDTHxHEIGHT with both from 1 to 16384, e.g. 1024x512",
                                      sim::printable(text)));
  }
  return r;
}

FrameRange parse_frames(const std::string& text) {
  FrameRange r;
  const char* end = text.data() + text.size();
  const auto [colon, bad_first] = std::from_chars(text.data(), end, r.first);
  bool good = bad_first == std::errc{};
  if (good && colon == end) {
    r.last = r.first;
  } else if (good) {
    const auto [rest, bad_last] = std::from_chars(std::min(colon + 1, end), end, r.last);
    good = *colon == ':' && bad_last == std::errc{} && rest == end && r.first <= r.last;
  }
  if (!good) {
    throw sim::InputError(
        fmt::format("--frames '{}' is not A:B with A no greater than B, or A alone, e.g. 0:29", sim::printable(text)));
  }
  return r;
}

}  // namespace tools
