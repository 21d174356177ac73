#pragma once
#include <span>
#include <string>
#include <string_view>

namespace traces {

/// Fit for one line of a message: control characters become '?', long text is cut.
std::string printable(std::string_view text);

/// ", did you mean 'x'?" for the candidate at the smallest edit distance, or nothing if all are far off.
std::string did_you_mean(std::string_view text, std::span<const std::string> candidates);

}  // namespace traces
