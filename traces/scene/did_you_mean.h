#pragma once
#include <span>
#include <string>
#include <string_view>

namespace traces {

/// Returns ", did you mean 'x'?" to append to an error message. x is the shortest candidate that begins with `text`, or
/// otherwise the one with the smallest edit distance. Returns an empty text if no candidate is similar.
std::string did_you_mean(std::string_view text, std::span<const std::string> candidates);

}  // namespace traces
