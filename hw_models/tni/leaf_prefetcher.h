#pragma once
#include <algorithm>
#include <cstdint>
#include <vector>

#include "hw_models/tni/fetch_stage.h"
#include "hw_models/tni/messages.h"
#include "hw_models/tni/timing_wheel.h"
#include "hw_models/tni/tree_in_memory.h"
#include "sim/link.h"

namespace hw {

/// Prefetches the triangles of leaves into the L1 of an intersection unit. Traversal units send the leaves, which are
/// on the stacks of their rays.
///
///   leaves from all TRVs --> [lines of one leaf] --> [one probe per cycle] --> L1 miss
///
/// 1. A prefetch probes the L1 after the demand access of the cycle. It leaves an MSHR free for demand misses, and
/// waits until it can.
/// 2. When all lines of a leaf have been probed, the next leaf is taken, round robin among the traversal units.
class LeafPrefetcher {
 public:
  struct Stats {
    std::uint64_t probes = 0, requests = 0;
  };

  /// `leaves_in`: one link from each traversal unit, which carries leaves to prefetch.
  LeafPrefetcher(const TrianglesInMemory& triangles, std::vector<sim::Link<LeafPrefetch>*> leaves_in);

  /// Probes the L1 for the next line. Returns false if there is none, or no MSHR to spare.
  bool issue_prefetch(FetchStage& fetch, const Cycle& cycle);
  /// Returns the earliest time, from `next` on, at which issue_prefetch() can do something without a fill before.
  sim::Time next_wake(const FetchStage& fetch, sim::Time next) const {
    if (next_line_ == lines_.size()) return std::max(next, leaves_in_.pop_at());
    return fetch.can_prefetch() ? next : sim::kNever;
  }
  /// True if no line is left to be probed, and no leaf is on its way.
  bool is_empty() const { return next_line_ == lines_.size() && leaves_in_.nonempty_mask() == 0; }
  const Stats& stats() const { return stats_; }

 private:
  /// Takes the next leaf, if one has arrived, and lists its lines.
  void take_leaf(sim::Time now);

  const TrianglesInMemory triangles_;
  const sim::Inputs<LeafPrefetch> leaves_in_;
  Arbiter sources_;
  std::vector<Addr> lines_;    ///< lines of the leaf
  std::size_t next_line_ = 0;  ///< index of the line that is probed next
  TileTag tile_ = kNoTile;     ///< tile of the leaf's ray
  Stats stats_;
};

}  // namespace hw
