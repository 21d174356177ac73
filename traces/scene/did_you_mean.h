#pragma once
#include <span>
#include <string>
#include <string_view>

namespace traces {

/// ", did you mean 'x'?" for the candidate at the smallest edit distance, or nothing if all are far off.
std::string did_you_mean(std::string_view text, std::span<const std::string> candidates);

}  // namespace traces
