#include "traces/scene/did_you_mean.h"

#include "sim/edit_distance.h"

namespace traces {
std::string did_you_mean(std::string_view text, std::span<const std::string> candidates) {
  const std::string_view start = text.substr(0, 64);
  std::size_t best = start.size() / 2 + 1;
  std::string_view found;
  for (const std::string& candidate : candidates) {
    const std::size_t distance = sim::edit_distance(start, candidate);
    if (distance < best) best = distance, found = candidate;
  }
  return found.empty() ? "" : ", did you mean '" + std::string(found) + "'?";
}

}  // namespace traces
