#include "traces/scene/did_you_mean.h"

#include <algorithm>
#include <numeric>
#include <vector>

namespace traces {
namespace {

std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 0; i < a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i + 1;
    for (std::size_t j = 0; j < b.size(); ++j) {
      const std::size_t replaced = diagonal + (a[i] == b[j] ? 0 : 1);
      diagonal = row[j + 1];
      row[j + 1] = std::min({replaced, diagonal + 1, row[j] + 1});
    }
  }
  return row.back();
}

}  // namespace

std::string did_you_mean(std::string_view text, std::span<const std::string> candidates) {
  const std::string_view start = text.substr(0, 64);
  std::size_t best = start.size() / 2 + 1;
  std::string_view found;
  for (const std::string& candidate : candidates) {
    const std::size_t distance = edit_distance(start, candidate);
    if (distance < best) best = distance, found = candidate;
  }
  return found.empty() ? "" : ", did you mean '" + std::string(found) + "'?";
}

}  // namespace traces
