#pragma once
#include <algorithm>
#include <cstdint>
#include <memory>
#include <vector>

#include "hw_models/tni/fetch_stage.h"
#include "hw_models/tni/messages.h"
#include "hw_models/tni/tni_config.h"
#include "hw_models/tni/tree_in_memory.h"
#include "hw_models/tni/treelets.h"
#include "sim/link.h"
#include "sim/named.h"
#include "sim/ring.h"

namespace hw {

/// Prefetches lines of nodes into the L1 of a traversal unit, and has the intersection unit prefetch those of leaves.
///
///   pop that follows a pop --> the next K stack entries --------------+--> nodes --> [queue] --> L1, one per cycle
///   miss of a treelet's root --> [map] --> the rest of the treelet ---+--> leaves --> [queue] --> intersection unit
///
/// 1. prefetch: stack. A pop follows a pop if the ray has pushed no entry in between, so the ray climbs. A leaf that a
/// visit enters directly counts as popped, because units that push all children would pop it. The next K entries are
/// those below the popped one that are in the short stack. The youngest entries that begin beyond the hit are read,
/// because they have distances, but not prefetched. Entries of nodes (stack_push: node) count once for each of their
/// children.
/// 2. prefetch: treelet. The first miss on the line of a treelet's root reads the treelet's entry and list in the map
/// (treelets.h), line by line through the L1. Then all nodes and leaves of the list are queued. Up to 8 lists are read
/// at once; further treelets are dropped.
/// 3. A prefetch probes the L1 after the demand access of the cycle; reads of the map go first. Both leave an MSHR free
/// for demand misses, and wait until they can. One leaf per cycle is sent to the intersection unit. If a queue is full,
/// further lines or leaves are dropped.
///
/// Not modelled: a second stack for nodes outside of the treelet, which would change the order of visits.
class NodePrefetcher {
 public:
  struct Stats {
    std::uint64_t stack_reads = 0, probes = 0, requests = 0, dropped = 0, leaves = 0;
    std::uint64_t map_reads = 0, map_misses = 0;  ///< lines of the map read; those of them whose probe missed
    std::uint64_t map_fills = 0;                  ///< lines of the map requested from memory
  };

  /// `treelets`: treelets of the scene, with prefetch: treelet; otherwise null. `leaves_out`: to the intersection unit;
  /// null if its L1 has no MSHR for prefetches, so that leaves are dropped.
  NodePrefetcher(const TrvConfig& config, const TreeInMemory& tree, std::shared_ptr<const Treelets> treelets,
                 sim::Link<LeafPrefetch>* leaves_out);

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
  /// Notes that the ray is at a leaf.
  void enter_leaf(std::uint32_t slot) {
    if (keeps_stacks_) stacks_[slot].popped = true;
  }
  /// Begins to read the list of a treelet if `node` is its root. Called when the root's line has missed.
  void note_miss(std::uint32_t slot, std::uint32_t node);
  /// Continues the reads of the map that have waited for a line.
  void fill_line(Addr line);

  /// Returns the earliest time, from `next` on, at which the prefetcher can do something without a fill before.
  sim::Time next_wake(const FetchStage& fetch, sim::Time next) const;
  bool is_empty() const { return queue_.empty() && leaves_.empty() && map_reads_.empty(); }
  /// Reads the next line of the map, or prefetches the oldest queued line, if an MSHR is to spare. Returns false if
  /// nothing was done.
  bool issue_prefetch(FetchStage& fetch, std::uint64_t cycle);
  /// Sends the oldest queued leaf to the intersection unit, if there is room. Returns whether it was sent.
  bool send_leaf(const FetchStage& fetch, sim::Time now);
  const Stats& stats() const { return stats_; }

 private:
  struct Queued {
    Addr line = 0;
    std::uint32_t slot = 0;
  };
  struct QueuedLeaf {
    std::uint32_t link = 0, slot = 0;
  };
  struct RayStack {
    std::vector<std::uint32_t> links;  ///< all entries of the ray, oldest first, also those that were dropped
    bool popped = false;               ///< the ray's last operation on its stack was a pop
  };
  /// A read of a treelet's entry and list in the map.
  struct MapRead {
    std::uint32_t treelet = 0, slot = 0;
    Addr line = 0;            ///< line to be read next
    bool in_entry = true;     ///< `line` has the entry, not a part of the list
    bool is_missing = false;  ///< the read waits for the line
  };
  bool reads_map() const {
    return std::ranges::any_of(map_reads_, [](const MapRead& read) { return !read.is_missing; });
  }
  void read_map(FetchStage& fetch, std::uint64_t cycle);
  /// Continues after a line of the map. Returns false if it was the list's last: the treelet is queued.
  bool advance_map_read(MapRead& read);
  void queue_line(Addr line, std::uint32_t slot);
  void queue_link(std::uint32_t link, std::uint32_t slot);

  const std::uint32_t depth_;
  const bool keeps_stacks_;
  const bool can_issue_;  ///< the L1 has an MSHR that demand misses do not need
  const TreeInMemory& tree_;
  const std::shared_ptr<const Treelets> treelets_;
  sim::Link<LeafPrefetch>* const leaves_out_;
  std::vector<RayStack> stacks_;
  std::vector<Addr> lines_;  ///< scratch space: lines of a node
  std::uint32_t last_treelet_ = Treelets::kNone;
  std::vector<MapRead> map_reads_;
  sim::Ring<Queued> queue_;
  sim::Ring<QueuedLeaf> leaves_;
  Stats stats_;
};

}  // namespace hw
