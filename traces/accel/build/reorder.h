#pragma once
#include <cstdint>
#include <span>
#include <vector>

namespace traces {

/// Moves record order[i] to index i for all i, in place, along the cycles of the permutation.
template <class Record>
void reorder(std::span<Record> records, const std::vector<std::uint32_t>& order) {
  std::vector<bool> done(records.size(), false);
  for (std::uint32_t start = 0; start < order.size(); ++start) {
    if (done[start]) continue;
    const Record first = records[start];
    std::uint32_t to = start;
    for (std::uint32_t from = order[to]; from != start; to = from, from = order[to]) {
      records[to] = records[from];
      done[to] = true;
    }
    records[to] = first;
    done[to] = true;
  }
}

}  // namespace traces
