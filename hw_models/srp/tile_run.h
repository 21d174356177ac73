#pragma once
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "hw_models/memory/messages.h"
#include "traces/stream.h"

namespace hw {

/// Maximum number of rays of a tile: a ray's handle has 24 bits for its index.
inline constexpr std::uint32_t kMaxRays = 1U << 24;

/// Progress of a tile in flight: the finished items of each node of its work graph. Times are not part of it; the
/// shader core (SRP) tracks them.
class TileRun {
 public:
  /// Starts a tile. `chunk_items_limit`: maximum items per chunk of a launch. A chunk is ready when the inputs of all
  /// its items are ready. `missing_borders`: mask of the imported borders that are not in memory yet.
  void start_tile(const traces::TileWork& work, std::uint32_t chunk_items_limit, std::uint32_t missing_borders = 0,
                  TileTag tag = kNoTile);
  void set_missing_borders(std::uint32_t border_mask) { missing_ = border_mask; }
  void clear_tile() { work_ = nullptr; }

  bool is_active() const { return work_ != nullptr; }
  const traces::TileWork& work() const { return *work_; }
  TileTag tile_tag() const { return tile_tag_; }
  const traces::WorkNode& node(std::uint32_t node_id) const { return work_->nodes[node_id]; }
  std::uint32_t node_count() const { return static_cast<std::uint32_t>(work_->nodes.size()); }
  /// Returns the number of items of a work graph node, including idle items.
  std::uint32_t total_items(std::uint32_t node_id) const { return node(node_id).items + node(node_id).idle; }
  /// Returns the number of finished items of a work graph node.
  std::uint32_t done_items(std::uint32_t node_id) const { return progress_[node_id].done; }
  /// True if nodes that depend on the given work graph node may start. Idle items of the given node may still be
  /// running.
  bool releases_dependents(std::uint32_t node_id) const { return progress_[node_id].done >= node(node_id).items; }
  bool is_complete(std::uint32_t node_id) const { return progress_[node_id].done == total_items(node_id); }
  bool is_tile_complete() const { return nodes_left_ == 0; }
  /// True if the work graph node depends on rays or samples to rasterise, directly or through other nodes.
  bool depends_on_rays(std::uint32_t node_id) const { return progress_[node_id].follows_rays; }
  /// True if unfinished nodes depend on the given work graph node.
  bool is_awaited(std::uint32_t node_id) const { return progress_[node_id].readers > 0; }

  /// Returns the last launch n in graph order whose next chunk is ready and for which usable(n) is true, or kNone.
  /// Choosing the last launch makes consumers run before producers.
  template <class Usable>
  std::uint32_t next_launch(Usable&& usable) const {
    for (std::uint32_t n = node_count(); n-- > 0;) {
      if (node(n).kind == traces::WorkNode::Kind::kLaunch && is_ready(n) && usable(n)) return n;
    }
    return kNone;
  }
  /// Calls start(n) for each transfer or rasteriser node n that has become ready: its inputs are done and its imported
  /// border, if any, is in memory.
  template <class Start>
  void start_transfers(Start&& start) {
    std::size_t left = 0;
    awaits_border_ = false;
    for (const std::uint32_t n : transfers_) {
      const bool released = has_released_inputs(n), needs_border = released && has_missing_border(n);
      awaits_border_ |= needs_border;
      if (released && !needs_border) {
        start(n);
      } else {
        transfers_[left++] = n;
      }
    }
    transfers_.resize(left);
  }
  /// True if a transfer waits only for the border of another tile.
  bool is_awaiting_border() const { return awaits_border_; }
  /// Returns the number of items in the next chunk of a launch, including idle ones.
  std::uint32_t next_chunk_size(std::uint32_t launch) const;
  /// Returns the item that produces ray number `ray_index` of a batch. The item belongs to the launch that produces the
  /// batch.
  std::uint32_t source_item(std::uint32_t batch, std::uint32_t ray_index) const {
    const std::uint32_t map = node(batch).sources;
    return map == traces::WorkNode::kNone ? ray_index : work_->sources[map + ray_index];
  }
  /// Returns the launch that produces the rays of batch `batch`.
  std::uint32_t producing_launch(std::uint32_t batch) const { return node(batch).inputs.front().node; }
  /// Returns the batches that a launch produces: batches of rays, and of samples to be rasterised.
  std::span<const std::uint32_t> batches_of(std::uint32_t launch) const {
    return std::span(batches_).subspan(progress_[launch].first_batch, progress_[launch].batches);
  }
  /// Returns the number of items among `first` to `first + items - 1` of a launch that are not idle. Idle items follow
  /// the launch's last real item.
  std::uint32_t non_idle_items(std::uint32_t launch, std::uint32_t first, std::uint32_t items) const {
    return std::min(first + items, node(launch).items) - std::min(first, node(launch).items);
  }
  /// Returns the number of rays that items `first` to `first + items - 1` of a launch produce, over all its batches.
  std::uint32_t count_produced_rays(std::uint32_t launch, std::uint32_t first, std::uint32_t items) const;
  std::uint32_t batch_of(std::uint32_t ray) const { return batch_of_ray_[ray]; }

  /// Marks `items` more items of a launch or transfer as finished. Returns the number of ray slots that become free.
  std::uint32_t finish_items(std::uint32_t node_id, std::uint32_t items);
  /// Marks a ray of the tile as returned from the T&I unit. Returns true if that may have made another node ready.
  bool finish_ray(std::uint32_t ray);

  static constexpr std::uint32_t kNone = 0xffffffffU;

 private:
  struct Progress {
    std::uint32_t done = 0;
    std::uint32_t prefix = 0;   ///< for a batch of rays: number of its first rays, in whole chunks, that have returned
    std::uint32_t readers = 0;  ///< number of unfinished nodes that need the node's results or ray slots
    bool follows_rays = false;
    std::uint32_t first_batch = 0, batches = 0;  ///< for a launch: range of its batches in `batches_`
    std::uint32_t first_chunk = 0;               ///< for a batch of rays: index of its first chunk in `chunk_left_`
  };
  void collect_batches();
  bool is_ready(std::uint32_t launch) const;
  bool has_released_inputs(std::uint32_t node_id) const;
  bool has_missing_border(std::uint32_t node_id) const {
    return node(node_id).border != kNone && !node(node_id).to_memory && (missing_ >> node(node_id).border & 1U) != 0;
  }
  std::uint32_t available_items(std::uint32_t node_id, const traces::Edge& edge) const;

  const traces::TileWork* work_ = nullptr;
  std::uint32_t chunk_ = 1;
  std::uint32_t missing_ = 0;  ///< mask of the imported borders that are not in memory yet
  TileTag tile_tag_ = kNoTile;
  bool awaits_border_ = false;
  std::uint32_t nodes_left_ = 0;
  std::vector<Progress> progress_;
  std::vector<std::uint32_t> transfers_;   ///< transfer and rasteriser nodes that have not started
  std::vector<std::uint32_t> batches_;     ///< all batches, grouped by the launch that produces them
  std::vector<std::uint32_t> chunk_left_;  ///< number of rays that have not returned, for each chunk of each batch
  std::vector<std::uint32_t> batch_of_ray_;
};

}  // namespace hw
