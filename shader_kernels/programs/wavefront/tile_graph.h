#pragma once
#include <cstdint>
#include <vector>

#include "shader_kernels/catalogue.h"
#include "shader_kernels/programs/wavefront/port_binding.h"
#include "shader_kernels/programs/wavefront/scene_tables.h"
#include "shader_kernels/programs/wavefront/stream_builder.h"
#include "shader_kernels/programs/wavefront/tile_result.h"

namespace kernels {

/// Runs kernels on a tile's buffer, and records each launch and transfer as a node of the tile's work with the nodes
/// that it waits for.
class TileGraph {
 public:
  using Node = StreamBuilder::Node;
  static constexpr Node kNone = StreamBuilder::kNone;

  TileGraph(const SceneTables& scene, bool record, TileResult& out);

  /// Runs kernel K over `items` items and records the launch. Unbound ports are bound by name, and the queues that K
  /// fills get their lengths. `lanes`: items of the inspector's queue; divergent kernels (RenderConfig::streams) run
  /// over all of them. `padding`: empty entries of K's queue.
  template <class K>
  Node launch(typename K::template Ports<float>& ports, std::uint32_t items, std::uint32_t lanes = 0,
              std::uint32_t padding = 0);
  template <class K>
  Node launch(std::uint32_t items, std::uint32_t lanes = 0) {
    typename K::template Ports<float> ports;
    return launch<K>(ports, items, lanes);
  }
  /// Records a launch, without memory accesses, whose results are already known.
  template <class K>
  Node note(std::uint32_t items) {
    return stream_.launch(kKernelId<K>, items, false);
  }

  void wait_all(Node node, Node for_node) { stream_.wait(node, for_node, traces::Edge::Kind::kAll); }
  void wait_each(Node node, Node for_node) { stream_.wait(node, for_node, traces::Edge::Kind::kEach); }
  /// Make `node` wait for all nodes so far that add to samples' colours, or that write samples' records.
  void wait_for_colours(Node node);
  void wait_for_records(Node node);
  void register_colour_writer(Node node) { scratch_.colour_writers.push_back(node); }
  void register_record_writer(Node node) { scratch_.record_writers.push_back(node); }
  /// Replaces all colour writers so far by `node`, which has waited for them.
  void replace_colour_writers(Node node) { scratch_.colour_writers.assign(1, node); }

  Node transfer(traces::Region region, bool to_memory, std::uint64_t offset, std::uint32_t bytes) {
    return stream_.transfer(region, to_memory, offset, bytes);
  }
  Node export_border(std::uint32_t number, std::uint64_t offset, std::uint32_t bytes) {
    return stream_.export_border(number, offset, bytes);
  }
  Node import_border(traces::Border border, std::uint64_t offset, std::uint32_t bytes) {
    return stream_.import_border(border, offset, bytes);
  }
  /// Exports samples after all writers of their records and colours so far.
  void export_samples(std::uint32_t number, std::uint64_t offset, std::uint32_t bytes);
  /// Imports samples; the transfer counts as a writer of records and colours.
  void import_samples(traces::Border border, std::uint64_t offset, std::uint32_t bytes);

  /// Encodes the tile's pixels after `averaged`, and writes them to byte `offset` of the picture.
  void write_pixels(Node averaged, std::uint64_t offset);
  /// Writes the pixels that `packed` encoded.
  void write_packed(Node packed, std::uint64_t offset);
  /// Writes pixels that the DMA encodes; returns the transfer.
  Node write_linear(std::uint64_t offset);

  /// While muted, kernels run but nothing is recorded, because the work belongs to another tile.
  void mute() { stream_.mute(true); }
  void unmute() { stream_.mute(false); }
  bool is_muted() const { return stream_.is_muted(); }
  bool is_recording() const { return stream_.is_on(); }
  void finish() { stream_.finish(); }

  StreamBuilder& stream() { return stream_; }

 private:
  std::vector<traces::Access>* accesses() { return stream_.is_on() ? &out_.work.accesses : nullptr; }

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
  const Node node = stream_.launch(kKernelId<K>, items, kReads, idle);
  bind_ports<K>(ports, out_, scene_, accesses());
  typename K::template Ports<float> at = ports;  // local copy so that the compiler keeps it in registers
  if (!stream_.is_on()) {
    for (std::uint32_t i = 0; i < items; ++i) K::template body<float>(i, at);
  } else {
    for (std::uint32_t i = 0; i < items; ++i) {
      if constexpr (kReads) stream_.begin_item();
      if constexpr (kEmits) {
        const std::uint32_t before = at.emitted.value;
        K::template body<float>(i, at);
        if (at.emitted.value != before) stream_.add_source(i);
      } else {
        K::template body<float>(i, at);
      }
    }
  }
  ports = at;
  count_queued<K>(ports, out_);
  return node;
}

}  // namespace kernels
