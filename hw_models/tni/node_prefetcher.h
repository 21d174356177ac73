#pragma once
#include <cstdint>
#include <memory>
#include <vector>

#include "hw_models/tni/fetch_stage.h"
#include "hw_models/tni/tni_config.h"
#include "hw_models/tni/tree_in_memory.h"
#include "hw_models/tni/treelets.h"
#include "sim/named.h"
#include "sim/ring.h"

namespace hw {

/// Prefetches node lines into the L1 of a traversal unit.
///
///   pop that follows a pop --> nodes of the next K stack entries --+
///   miss of a treelet's root --> other lines of the treelet -------+--> queue --> [one probe per cycle] --> L1 miss
///
/// 1. prefetch: stack. A pop follows a pop if the ray has pushed no entry in between, so the ray climbs. The next K
/// entries are those below the popped one that are in the short stack. Leaves need no node line. The youngest entries
/// that begin beyond the hit are read, because they have distances, but not prefetched. Entries of nodes
/// (stack_push: node) count once for each of their children.
/// 2. prefetch: treelet. The first miss on the line of a treelet's root queues all other lines of the treelet.
/// 3. A prefetch probes the L1 after the demand access of the cycle. It leaves an MSHR free for demand misses, and
/// waits until it can. If the queue is full, further lines are dropped.
///
/// Not modelled: a second stack for nodes outside of the treelet, which would change the order of visits.
class NodePrefetcher {
 public:
  struct Stats {
    std::uint64_t stack_reads = 0, probes = 0, requests = 0, dropped = 0;
  };

  /// `treelets`: treelets of the scene, with prefetch: treelet; otherwise null.
  NodePrefetcher(const TrvConfig& config, const TreeInMemory& tree, std::shared_ptr<const Treelets> treelets);

  void begin_ray(std::uint32_t slot);
  /// Notes that a binary visit pushed the child at `link`.
  void push_entry(std::uint32_t slot, std::uint32_t link);
  /// Notes that a wide visit pushed all hit children but the first. `hits`: the walk's word of hits.
  void push_entries_of(std::uint32_t slot, std::uint32_t node, std::uint32_t hits);
  /// Records a pop. If the ray's previous stack operation was also a pop, queues prefetches of remaining entries.
  /// `resident`: entries left in the short stack; the youngest `culled` of them begin beyond the ray's hit.
  void pop_entry(std::uint32_t slot, std::uint32_t resident, std::uint32_t culled);
  /// Notes that a restart took the youngest entry without a pop.
  void take_entry(std::uint32_t slot);
  /// Queues the rest of a treelet if `node` is its root. Called when the root's line has missed.
  void note_miss(std::uint32_t slot, std::uint32_t node);

  bool has_work(const FetchStage& fetch) const { return !queue_.empty() && fetch.can_prefetch(); }
  bool is_empty() const { return queue_.empty(); }
  /// Prefetches the oldest queued line, if an MSHR is to spare. Returns false if nothing was done.
  bool issue_prefetch(FetchStage& fetch, std::uint64_t cycle);
  const Stats& stats() const { return stats_; }

 private:
  struct Queued {
    Addr line = 0;
    std::uint32_t slot = 0;
  };
  struct RayStack {
    std::vector<std::uint32_t> links;  ///< all entries of the ray, oldest first, also those that were dropped
    bool popped = false;               ///< the ray's last operation on its stack was a pop
  };
  void queue_line(Addr line, std::uint32_t slot);
  void queue_link(std::uint32_t link, std::uint32_t slot);

  const std::uint32_t depth_;
  const bool keeps_stacks_;
  const bool can_issue_;  ///< the L1 has an MSHR that demand misses do not need
  const TreeInMemory& tree_;
  const std::shared_ptr<const Treelets> treelets_;
  std::vector<RayStack> stacks_;
  std::vector<Addr> lines_;  ///< scratch space: lines of a node
  std::uint32_t last_treelet_ = Treelets::kNone;
  sim::Ring<Queued> queue_;
  Stats stats_;
};

}  // namespace hw
