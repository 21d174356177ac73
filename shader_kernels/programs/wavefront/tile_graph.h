#pragma once
#include <cstddef>
#include <cstdint>
#include <vector>

#include "shader_kernels/catalogue.h"
#include "shader_kernels/programs/wavefront/port_binding.h"
#include "shader_kernels/programs/wavefront/scene_tables.h"
#include "shader_kernels/programs/wavefront/tile_result.h"
#include "traces/stream.h"

namespace kernels {

/// Builds a tile's graph of work, node by node. The storage of the previous contents is reused; unused nodes are kept
/// in `spare`. All functions do nothing if recording is off.
class StreamBuilder {
 public:
  using Node = std::uint32_t;
  static constexpr Node kNone = traces::WorkNode::kNone;

  StreamBuilder(traces::TileWork& work, std::vector<traces::WorkNode>& spare, bool on);
  bool is_enabled() const { return on_ && !muted_; }
  /// While the builder is muted, it records nothing.
  void set_muted(bool muted) { muted_ = muted; }
  bool is_muted() const { return muted_; }

  /// Adds the launch of a kernel over `items` items, followed by `idle` loop iterations that do no work.
  Node add_launch(traces::KernelId kernel, std::uint32_t items, bool has_accesses, std::uint32_t idle = 0);
  /// Begins the list of memory accesses of the next item of the last added launch. Call only if the launch has
  /// accesses.
  void begin_item_accesses() { work_.access_begin.push_back(static_cast<std::uint32_t>(work_.accesses.size())); }
  /// Records that item `item` of the last launch emitted a ray.
  void add_ray_source(std::uint32_t item) { work_.sources.push_back(item); }
  /// Adds a batch of rays that `launch` emitted: one per item or, if `is_mapped`, one per call of add_ray_source()
  /// since the launch.
  Node add_rays(traces::RayKind kind, std::uint32_t ray_count, std::uint32_t first, Node launch, bool is_mapped);
  Node add_transfer(traces::Region region, bool to_memory, std::uint64_t offset, std::uint32_t bytes);
  /// Adds a node that rasterises `samples` samples, whose rays `launch` generated. The last entry of TileWork::raster
  /// describes the rasterisation.
  Node add_rasterisation(std::uint32_t samples, Node launch);
  /// Adds a node that bins triangles to screen regions. The last entry of TileWork::raster describes the binning.
  Node add_binning(std::uint32_t triangles);
  /// Adds a transfer of samples to memory. Border `number` of the tile is complete when the transfer has ended.
  Node export_border(std::uint32_t number, std::uint64_t offset, std::uint32_t bytes);
  /// Adds a transfer of samples from memory. The transfer waits until another tile has written its border.
  Node import_border(traces::Border border, std::uint64_t offset, std::uint32_t bytes);
  void add_wait(Node node, Node for_node, traces::Edge::Kind kind);
  void finish();

 private:
  traces::WorkNode& add_node(traces::WorkNode::Kind kind, std::uint32_t items);

  traces::TileWork& work_;
  std::vector<traces::WorkNode>& spare_;
  bool on_;
  bool muted_ = false;
  Node count_ = 0;
  std::uint32_t launch_sources_ = 0;  ///< index in TileWork::sources of the first source of the last launch
};

/// Runs kernels on a tile's buffer. Each launch and transfer becomes a node of the tile's graph of work; nodes wait for
/// others.
class TileGraph {
 public:
  using Node = StreamBuilder::Node;
  static constexpr Node kNone = StreamBuilder::kNone;

  TileGraph(const SceneTables& scene, bool record, TileResult& out);

  /// Runs kernel K over `items` items and records the launch. Unbound ports are bound by name, and the lengths of the
  /// queues that K fills are set. `lanes`: number of items from which the entries of K's queue were selected. Without
  /// compaction (RenderConfig::streams) the launch runs over all these items. `padding`: number of empty entries in K's
  /// queue.
  template <class K>
  Node launch(typename K::template Ports<float>& ports, std::uint32_t items, std::uint32_t lanes = 0,
              std::uint32_t padding = 0);
  template <class K>
  Node launch(std::uint32_t items, std::uint32_t lanes = 0) {
    typename K::template Ports<float> ports;
    return launch<K>(ports, items, lanes);
  }
  /// Records a launch of kernel K without running the kernel, because the host already has the results. K has no memory
  /// accesses.
  template <class K>
  Node record_known_launch(std::uint32_t items) {
    return stream_.add_launch(kKernelId<K>, items, false);
  }

  void wait_for_all(Node node, Node for_node) { stream_.add_wait(node, for_node, traces::Edge::Kind::kAll); }
  void wait_item_by_item(Node node, Node for_node) { stream_.add_wait(node, for_node, traces::Edge::Kind::kEach); }
  /// wait_for_colour_writers() makes `node` wait for all earlier nodes that add to samples' colours,
  /// wait_for_record_writers() for all that write samples' records.
  void wait_for_colour_writers(Node node);
  void wait_for_record_writers(Node node);
  void register_colour_writer(Node node) { scratch_.colour_writers.push_back(node); }
  void register_record_writer(Node node) { scratch_.record_writers.push_back(node); }
  /// Makes later readers of colours wait for `node` only. `node` must itself wait for all earlier colour writers.
  void replace_colour_writers(Node node) { scratch_.colour_writers.assign(1, node); }

  Node add_transfer(traces::Region region, bool to_memory, std::uint64_t offset, std::uint32_t bytes) {
    return stream_.add_transfer(region, to_memory, offset, bytes);
  }
  Node export_border(std::uint32_t number, std::uint64_t offset, std::uint32_t bytes) {
    return stream_.export_border(number, offset, bytes);
  }
  Node import_border(traces::Border border, std::uint64_t offset, std::uint32_t bytes) {
    return stream_.import_border(border, offset, bytes);
  }
  /// Adds a transfer of border `number` to memory, after all earlier nodes that write records and colours.
  void export_samples(std::uint32_t number, std::uint64_t offset, std::uint32_t bytes);
  /// Adds a transfer of another tile's border from memory. The transfer counts as a writer of records and colours.
  void import_samples(traces::Border border, std::uint64_t offset, std::uint32_t bytes);

  /// Encodes the tile's pixels after node `averaged`, and writes them to byte `offset` of the picture.
  void write_pixels(Node averaged, std::uint64_t offset);
  /// Writes pixels that node `packed` has encoded to byte `offset` of the picture.
  void write_packed_pixels(Node packed, std::uint64_t offset);
  /// Writes linear pixels to byte `offset` of the picture; the DMA encodes them. Returns the transfer.
  Node write_linear_pixels(std::uint64_t offset);

  /// Stops recording: kernels still run on the host, but their work belongs to another tile.
  void pause_recording() { stream_.set_muted(true); }
  void resume_recording() { stream_.set_muted(false); }
  bool is_muted() const { return stream_.is_muted(); }
  bool is_recording() const { return stream_.is_enabled(); }
  void finish() { stream_.finish(); }

  StreamBuilder& stream_builder() { return stream_; }

 private:
  std::vector<traces::Access>* access_log() { return stream_.is_enabled() ? &out_.work.accesses : nullptr; }

  const SceneTables& scene_;
  TileResult& out_;
  TileScratch& scratch_;
  StreamBuilder stream_;
};

template <class K>
TileGraph::Node TileGraph::launch(typename K::template Ports<float>& ports, std::uint32_t items, std::uint32_t lanes,
                                  std::uint32_t padding) {
  constexpr bool kReads = kListsAccesses<typename K::template Ports<float>>;
  constexpr bool kEmits = requires { ports.emitted; };
  const std::uint32_t idle = scene_.diverges && lanes > items ? lanes - items : padding;
  const Node node = stream_.add_launch(kKernelId<K>, items, kReads, idle);
  bind_ports<K>(ports, out_, scene_, access_log());
  typename K::template Ports<float> at = ports;  // a local copy, so that the compiler keeps it in registers
  if (!stream_.is_enabled()) {
    for (std::uint32_t i = 0; i < items; ++i) K::template body<float>(i, at);
  } else {
    for (std::uint32_t i = 0; i < items; ++i) {
      if constexpr (kReads) stream_.begin_item_accesses();
      if constexpr (kEmits) {
        const std::uint32_t before = at.emitted.value;
        K::template body<float>(i, at);
        if (at.emitted.value != before) stream_.add_ray_source(i);
      } else {
        K::template body<float>(i, at);
      }
    }
  }
  ports = at;
  set_queue_lengths<K>(ports, out_);
  return node;
}

}  // namespace kernels
