#pragma once
#include <algorithm>
#include <cstddef>
#include <functional>
#include <ranges>
#include <string_view>
#include <vector>

namespace sim {

/// Returns the edit distance of two texts: the number of insertions, deletions, replacements and swaps of neighbouring
/// letters that turn one into the other.
inline std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::vector<std::size_t>> d(a.size() + 1, std::vector<std::size_t>(b.size() + 1));
  for (std::size_t i = 0; i <= a.size(); ++i) {
    for (std::size_t j = 0; j <= b.size(); ++j) {
      if (i == 0 || j == 0) {
        d[i][j] = i + j;
        continue;
      }
      const bool same = a[i - 1] == b[j - 1];
      d[i][j] = std::min({d[i - 1][j] + 1, d[i][j - 1] + 1, d[i - 1][j - 1] + (same ? 0 : 1)});
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1]) {
        d[i][j] = std::min(d[i][j], d[i - 2][j - 2] + 1);
      }
    }
  }
  return d[a.size()][b.size()];
}

/// Returns the first 64 bytes of a word. The limit bounds the time of edit_distance() for untrusted words.
constexpr std::string_view comparison_prefix(std::string_view word) { return word.substr(0, 64); }

/// Returns the element of `candidates` with the smallest edit distance to a word, the first among equals. Returns the
/// end of `candidates` if no element is within `max_edits` edits.
template <std::ranges::forward_range Candidates, class Name = std::identity>
auto find_nearest(std::string_view word, const Candidates& candidates, std::size_t max_edits, Name name_of = {}) {
  auto found = std::ranges::end(candidates);
  std::size_t best = max_edits + 1;
  for (auto at = std::ranges::begin(candidates); at != std::ranges::end(candidates); ++at) {
    const std::size_t distance = edit_distance(word, std::invoke(name_of, *at));
    if (distance < best) best = distance, found = at;
  }
  return found;
}

}  // namespace sim
