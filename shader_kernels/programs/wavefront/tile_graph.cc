#include "shader_kernels/programs/wavefront/tile_graph.h"

namespace kernels {

TileGraph::TileGraph(const SceneTables& scene, bool record, TileResult& out)
    : scene_(scene),
      out_(out),
      scratch_(out.buffer.scratch),
      stream_(out.work, out.buffer.scratch.spare_nodes, record) {
  scratch_.colour_writers.clear();
  scratch_.record_writers.clear();
}

void TileGraph::wait_for_colours(Node node) {
  for (const Node writer : scratch_.colour_writers) wait_all(node, writer);
}

void TileGraph::wait_for_records(Node node) {
  for (const Node writer : scratch_.record_writers) wait_all(node, writer);
}

void TileGraph::export_samples(std::uint32_t number, std::uint64_t offset, std::uint32_t bytes) {
  const Node node = export_border(number, offset, bytes);
  wait_for_records(node);
  wait_for_colours(node);
}

void TileGraph::import_samples(traces::Border border, std::uint64_t offset, std::uint32_t bytes) {
  const Node node = import_border(border, offset, bytes);
  register_record_writer(node);
  register_colour_writer(node);
}

void TileGraph::write_pixels(Node averaged, std::uint64_t offset) {
  if (scene_.dma_encodes) return wait_all(write_linear(offset), averaged);
  const Node packed = launch<PackColour>(static_cast<std::uint32_t>(out_.linear.size()));
  wait_all(packed, averaged);
  write_packed(packed, offset);
}

void TileGraph::write_packed(Node packed, std::uint64_t offset) {
  const auto bytes = static_cast<std::uint32_t>(out_.linear.size()) * kPixelBytes;
  wait_all(transfer(traces::Region::kPicture, true, offset, bytes), packed);
}

TileGraph::Node TileGraph::write_linear(std::uint64_t offset) {
  const auto pixels = static_cast<std::uint32_t>(out_.linear.size());
  PackColour::Ports<float> ports;
  bind_ports<PackColour>(ports, out_, scene_, nullptr);
  for (std::uint32_t i = 0; i < pixels; ++i) PackColour::body<float>(i, ports);
  return transfer(traces::Region::kPicture, true, offset, pixels * kPixelBytes);
}

}  // namespace kernels
