#pragma once
#include <span>
#include <string>
#include <string_view>

namespace traces {

/// Returns ", did you mean 'x'?" for the shortest candidate that begins with `text`, else for the candidate at the
/// smallest edit distance; empty if all are far off.
std::string did_you_mean(std::string_view text, std::span<const std::string> candidates);

}  // namespace traces
