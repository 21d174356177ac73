#include "traces/scene/did_you_mean.h"

#include <algorithm>
#include <iterator>
#include <vector>

#include "sim/edit_distance.h"

namespace traces {
std::string did_you_mean(std::string_view text, std::span<const std::string> candidates) {
  const std::string_view start = sim::comparison_prefix(text);
  const auto suggestion = [](const std::string& candidate) { return ", did you mean '" + candidate + "'?"; };
  constexpr std::size_t kShortestBeginning = 3;
  if (start.size() >= kShortestBeginning) {
    std::vector<std::string> longer;
    std::ranges::copy_if(candidates, std::back_inserter(longer), [&](const auto& c) { return c.starts_with(text); });
    if (!longer.empty()) return suggestion(*std::ranges::min_element(longer, {}, &std::string::size));
  }
  const auto found = sim::find_nearest(start, candidates, start.size() / 2);
  return found == candidates.end() ? "" : suggestion(*found);
}

}  // namespace traces
