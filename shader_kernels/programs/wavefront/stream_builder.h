#pragma once
#include <cstddef>
#include <cstdint>
#include <vector>

#include "traces/stream.h"

namespace kernels {

/// Builds a tile's graph of work. It reuses the storage of the previous contents; unused nodes are kept in `spare`. A
/// builder that does not record does nothing.
class StreamBuilder {
 public:
  using Node = std::uint32_t;
  static constexpr Node kNone = traces::WorkNode::kNone;

  StreamBuilder(traces::TileWork& work, std::vector<traces::WorkNode>& spare, bool on);
  bool is_on() const { return on_ && !muted_; }
  /// A muted builder records nothing until it is unmuted.
  void mute(bool muted) { muted_ = muted; }
  bool is_muted() const { return muted_; }

  /// Adds a launch. `idle` is the number of inactive iterations after its items.
  Node launch(traces::KernelId kernel, std::uint32_t items, bool has_accesses, std::uint32_t idle = 0);
  /// Begins the next item of the last launch; for launches with accesses.
  void begin_item() { work_.access_begin.push_back(static_cast<std::uint32_t>(work_.accesses.size())); }
  /// Records that the last launch made a ray from `item`.
  void add_source(std::uint32_t item) { work_.sources.push_back(item); }
  /// Adds rays made by `launch`: one per item, or, if `is_mapped`, one per source added since that launch.
  Node rays(traces::RayKind kind, std::uint32_t count, std::uint32_t first, Node launch, bool is_mapped);
  Node transfer(traces::Region region, bool to_memory, std::uint64_t offset, std::uint32_t bytes);
  /// Adds the rasterised primary hits of `count` samples, whose rays `launch` made. Uses the last entry of the work's
  /// `raster`.
  Node raster(std::uint32_t count, Node launch);
  /// Adds the binning of triangles. Uses the last entry of the work's `raster`.
  Node bin(std::uint32_t triangles);
  /// Adds a transfer of samples that completes border `number` of the tile.
  Node export_border(std::uint32_t number, std::uint64_t offset, std::uint32_t bytes);
  /// Adds a transfer of samples that waits for another tile's border.
  Node import_border(traces::Border border, std::uint64_t offset, std::uint32_t bytes);
  void wait(Node node, Node for_node, traces::Edge::Kind kind);
  void finish();

 private:
  traces::WorkNode& add(traces::WorkNode::Kind kind, std::uint32_t items);

  traces::TileWork& work_;
  std::vector<traces::WorkNode>& spare_;
  bool on_;
  bool muted_ = false;
  Node count_ = 0;
  std::uint32_t launch_sources_ = 0;  ///< first source of the last launch
};

}  // namespace kernels
