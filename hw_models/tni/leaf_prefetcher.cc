#include "hw_models/tni/leaf_prefetcher.h"

#include <algorithm>
#include <utility>

namespace hw {

LeafPrefetcher::LeafPrefetcher(const TrianglesInMemory& triangles, std::vector<sim::Link<LeafPrefetch>*> leaves_in)
    : triangles_(triangles), leaves_in_(std::move(leaves_in)), sources_(Arbitration::kRoundRobin, leaves_in_.size()) {}

void LeafPrefetcher::take_leaf(sim::Time now) {
  if (leaves_in_.nonempty_mask() == 0) return;
  const std::uint32_t trv = sources_.choose_requester(
      leaves_in_.nonempty_mask(), [&](std::uint32_t i) { return leaves_in_.can_pop(i, now); },
      [](std::uint32_t) { return sim::Time{0}; });
  if (trv == sources_.requester_count()) return;
  sources_.note_served(trv);
  const LeafPrefetch leaf = leaves_in_[trv].pop(now);
  tile_ = leaf.tile;
  lines_.clear();
  next_line_ = 0;
  triangles_.append_leaf_lines(leaf.first, leaf.count, lines_);
}

bool LeafPrefetcher::issue_prefetch(FetchStage& fetch, const Cycle& cycle) {
  if (next_line_ == lines_.size()) take_leaf(cycle.now);
  if (next_line_ == lines_.size() || !fetch.can_prefetch()) return false;
  stats_.probes += 1;
  stats_.requests += fetch.prefetch_line(lines_[next_line_++], tile_, cycle.number);
  return true;
}

}  // namespace hw
