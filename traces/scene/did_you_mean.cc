#include "traces/scene/did_you_mean.h"

#include "sim/edit_distance.h"

namespace traces {
std::string did_you_mean(std::string_view text, std::span<const std::string> candidates) {
  const std::string_view start = sim::start_of(text);
  const auto found = sim::nearest_of(start, candidates, start.size() / 2);
  return found == candidates.end() ? "" : ", did you mean '" + *found + "'?";
}

}  // namespace traces
