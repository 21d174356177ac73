#include "shader_kernels/programs/wavefront/tile_graph.h"

#include <algorithm>
#include <cassert>
#include <utility>

namespace kernels {

using traces::Edge;
using traces::WorkNode;

StreamBuilder::StreamBuilder(traces::TileWork& work, std::vector<WorkNode>& spare, bool on)
    : work_(work), spare_(spare), on_(on) {
  work.walk.clear();
  work.ray_begin.clear();
  work.ray_keys.clear();
  work.accesses.clear();
  work.access_begin.clear();
  work.sources.clear();
  work.imports.clear();
  work.raster.clear();
  work.raster_triangles.clear();
  work.list_runs.clear();
  work.build.clear();
  work.build_triangles.clear();
  work.build_order.clear();
  work.after_all = false;
}

namespace {

constexpr std::size_t kUsualInputs = 32;

}  // namespace

WorkNode& StreamBuilder::add_node(WorkNode::Kind kind, std::uint32_t items) {
  if (count_ == work_.nodes.size()) {
    if (spare_.empty()) spare_.emplace_back().inputs.reserve(kUsualInputs);
    work_.nodes.push_back(std::move(spare_.back()));
    spare_.pop_back();
  }
  WorkNode& node = work_.nodes[count_++];
  std::vector<Edge> inputs = std::move(node.inputs);
  inputs.clear();
  node = {.kind = kind, .items = items, .inputs = std::move(inputs)};
  return node;
}

StreamBuilder::Node StreamBuilder::add_launch(traces::KernelId kernel, std::uint32_t items, bool has_accesses,
                                              std::uint32_t idle) {
  if (!is_enabled()) return kNone;
  launch_sources_ = static_cast<std::uint32_t>(work_.sources.size());
  WorkNode& node = add_node(WorkNode::Kind::kLaunch, items);
  node.kernel = kernel;
  node.has_accesses = has_accesses;
  node.idle = idle;
  if (has_accesses) node.first = static_cast<std::uint32_t>(work_.access_begin.size());
  return count_ - 1;
}

StreamBuilder::Node StreamBuilder::add_rays(traces::RayKind kind, std::uint32_t ray_count, std::uint32_t first,
                                            Node launch, bool is_mapped) {
  if (!is_enabled()) return kNone;
  WorkNode& node = add_node(WorkNode::Kind::kRays, ray_count);
  node.ray_kind = kind;
  node.first = first;
  if (is_mapped) node.sources = launch_sources_;
  node.inputs.push_back({launch, Edge::Kind::kEach});
  return count_ - 1;
}

StreamBuilder::Node StreamBuilder::add_transfer(traces::Region region, bool to_memory, std::uint64_t offset,
                                                std::uint32_t bytes) {
  if (!is_enabled()) return kNone;
  WorkNode& node = add_node(WorkNode::Kind::kTransfer, bytes);
  node.region = region;
  node.to_memory = to_memory;
  node.offset = offset;
  return count_ - 1;
}

StreamBuilder::Node StreamBuilder::add_rasterisation(std::uint32_t samples, Node launch) {
  if (!is_enabled()) return kNone;
  WorkNode& node = add_node(WorkNode::Kind::kRaster, samples);
  node.raster = static_cast<std::uint32_t>(work_.raster.size() - 1);
  node.inputs.push_back({launch, Edge::Kind::kEach});
  return count_ - 1;
}

StreamBuilder::Node StreamBuilder::add_binning(std::uint32_t triangles) {
  if (!is_enabled()) return kNone;
  add_node(WorkNode::Kind::kBin, triangles).raster = static_cast<std::uint32_t>(work_.raster.size() - 1);
  return count_ - 1;
}

StreamBuilder::Node StreamBuilder::add_build(std::uint32_t items) {
  if (!is_enabled()) return kNone;
  add_node(WorkNode::Kind::kBuild, items).first = static_cast<std::uint32_t>(work_.build.size() - 1);
  return count_ - 1;
}

StreamBuilder::Node StreamBuilder::export_border(std::uint32_t number, std::uint64_t offset, std::uint32_t bytes) {
  assert(number < traces::kMostBorders);
  const Node node = add_transfer(traces::Region::kSamples, true, offset, bytes);
  if (node != kNone) work_.nodes[node].border = number;
  return node;
}

StreamBuilder::Node StreamBuilder::import_border(traces::Border border, std::uint64_t offset, std::uint32_t bytes) {
  const Node node = add_transfer(traces::Region::kSamples, false, offset, bytes);
  if (node == kNone) return kNone;
  std::vector<traces::Border>& imports = work_.imports;
  const auto known = std::ranges::find(imports, border);
  work_.nodes[node].border = static_cast<std::uint32_t>(known - imports.begin());
  if (known == imports.end()) imports.push_back(border);
  assert(imports.size() <= traces::kMostImports);
  return node;
}

void StreamBuilder::add_wait(Node node, Node for_node, Edge::Kind kind) {
  if (node != kNone && for_node != kNone) work_.nodes[node].inputs.push_back({for_node, kind});
}

void StreamBuilder::finish() {
  if (on_) begin_item_accesses();
  while (work_.nodes.size() > count_) {
    spare_.push_back(std::move(work_.nodes.back()));
    work_.nodes.pop_back();
  }
}

TileGraph::TileGraph(const SceneTables& scene, bool record, TileResult& out)
    : scene_(scene),
      out_(out),
      scratch_(out.buffer.scratch),
      stream_(out.work, out.buffer.scratch.spare_nodes, record) {
  scratch_.colour_writers.clear();
  scratch_.record_writers.clear();
}

void TileGraph::wait_for_colour_writers(Node node) {
  for (const Node writer : scratch_.colour_writers) wait_for_all(node, writer);
}

void TileGraph::wait_for_record_writers(Node node) {
  for (const Node writer : scratch_.record_writers) wait_for_all(node, writer);
}

void TileGraph::export_samples(std::uint32_t number, std::uint64_t offset, std::uint32_t bytes) {
  const Node node = export_border(number, offset, bytes);
  wait_for_record_writers(node);
  wait_for_colour_writers(node);
}

void TileGraph::import_samples(traces::Border border, std::uint64_t offset, std::uint32_t bytes) {
  const Node node = import_border(border, offset, bytes);
  register_record_writer(node);
  register_colour_writer(node);
}

void TileGraph::write_pixels(Node averaged, std::uint64_t offset) {
  if (scene_.dma_encodes) return wait_for_all(write_linear_pixels(offset), averaged);
  const Node packed = launch<PackColour>(static_cast<std::uint32_t>(out_.linear.size()));
  wait_for_all(packed, averaged);
  write_packed_pixels(packed, offset);
}

void TileGraph::write_packed_pixels(Node packed, std::uint64_t offset) {
  const auto bytes = static_cast<std::uint32_t>(out_.linear.size()) * kPixelBytes;
  wait_for_all(add_transfer(traces::Region::kPicture, true, offset, bytes), packed);
}

TileGraph::Node TileGraph::write_linear_pixels(std::uint64_t offset) {
  const auto pixels = static_cast<std::uint32_t>(out_.linear.size());
  PackColour::Ports<float> ports;
  bind_ports<PackColour>(ports, out_, scene_, nullptr);
  for (std::uint32_t i = 0; i < pixels; ++i) PackColour::body<float>(i, ports);
  return add_transfer(traces::Region::kPicture, true, offset, pixels * kPixelBytes);
}

}  // namespace kernels
