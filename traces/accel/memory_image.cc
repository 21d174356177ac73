#include "traces/accel/memory_image.h"

#include <algorithm>
#include <utility>

#include <glm/geometric.hpp>

namespace traces {
namespace {

constexpr std::uint64_t align_to_line(std::uint64_t at) { return (at + 63) & ~std::uint64_t{63}; }

/// Returns, for each inner node, the indices of its children's records if a record holds a single box. Each tree is
/// stored depth first with a record per node and leaf: child 0 follows its parent, child 1 follows the subtree of child
/// 0. A kNoChild link has a record too, because traversal reads the boxes of both children.
std::vector<std::array<std::uint32_t, 2>> place_single_boxes(const std::vector<NodeRecord>& nodes) {
  const auto has_records = [](std::uint32_t link) { return !is_leaf(link) && link != kNoChild; };
  // Inner nodes are in depth-first order, so a backward pass sees children before their parents.
  std::vector<std::uint32_t> records(nodes.size());  // number of records of the node and its subtree
  for (std::size_t i = nodes.size(); i-- > 0;) {
    records[i] = 1;
    for (const std::uint32_t link : nodes[i].child) records[i] += has_records(link) ? records[link] : 1;
  }
  std::vector<std::array<std::uint32_t, 2>> children(nodes.size());
  std::vector<std::uint32_t> own(nodes.size(), kNone);
  std::uint32_t next_tree = 0;
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    if (own[i] == kNone) {  // a root, which no parent has placed
      own[i] = next_tree;
      next_tree += records[i];
    }
    std::uint32_t next = own[i] + 1;
    for (std::size_t c = 0; c < 2; ++c) {
      const std::uint32_t link = nodes[i].child[c];
      children[i][c] = next;
      if (has_records(link)) own[link] = next;
      next += has_records(link) ? records[link] : 1;
    }
  }
  return children;
}

}  // namespace

ImageCounts counts_of(const MemoryImage& image) {
  ImageCounts counts{.triangles = image.triangles.size(),
                     .attributes = image.attributes.size(),
                     .vertices = image.vertices.size(),
                     .materials = image.materials.size(),
                     .details = image.details.size(),
                     .textures = {},
                     .instances = image.instances.size(),
                     .trees = image.trees.size()};
  for (const Texture& texture : image.textures) counts.textures.push_back({texture.width, texture.height});
  return counts;
}

// Arrays that the scene does not need have size 0.
Layout layout_of(const ImageCounts& counts, const std::vector<NodeRecord>& nodes, const BvhConfig& config) {
  Layout at;
  at.node_bytes = node_bytes(config.numbers, config.boxes);
  if (config.boxes == BoxRecords::kSingle) at.single_boxes = place_single_boxes(nodes);
  at.triangle_bytes = config.triangle_bytes;
  std::uint64_t next = 0;
  const auto reserve = [&](std::uint64_t bytes) {
    const std::uint64_t base = next;
    next = align_to_line(next + bytes);
    return base;
  };
  at.nodes = reserve(at.node_bytes * node_records(nodes.size(), config.boxes, 1 + counts.trees));
  at.instances = reserve(counts.instances * sizeof(InstanceRecord));
  at.triangles = reserve(counts.triangles * at.triangle_bytes);
  at.labels = reserve(at.has_labels() ? counts.triangles * Layout::kLabelBytes : 0);
  at.attributes = reserve(counts.attributes * sizeof(AttributeRecord));
  at.vertices = reserve(counts.vertices * sizeof(VertexRecord));
  at.materials = reserve(counts.materials * sizeof(MaterialRecord));
  at.details = reserve(counts.details * sizeof(MaterialDetailRecord));
  for (const auto& [width, height] : counts.textures) {
    const std::uint32_t per_row = (width + 3) / 4;
    at.textures.push_back({reserve(std::uint64_t{per_row} * ((height + 3) / 4) * 64), per_row});
  }
  at.frame_buffer = at.end = next;
  return at;
}

bool MemoryImage::has_single_sided() const {
  return std::ranges::any_of(materials, [](const MaterialRecord& m) { return (m.flags & kSingleSided) != 0; });
}

float MemoryImage::diagonal() const { return glm::length(upper - lower); }

std::uint64_t MemoryImage::node_array_bytes() const {
  const BoxRecords boxes = layout.single_boxes.empty() ? BoxRecords::kPair : BoxRecords::kSingle;
  return layout.node_bytes * node_records(nodes.size(), boxes, 1 + trees.size());
}

std::vector<std::uint32_t> parent_indices(const MemoryImage& image) {
  const std::size_t nodes = image.nodes.size();
  std::vector<std::uint32_t> parents(nodes + image.instances.size());
  for (const ObjectTree& tree : image.trees) parents[tree.first_node] = tree.first_node;
  for (std::uint32_t node = 0; node < nodes; ++node) {
    for (const std::uint32_t link : image.nodes[node].child) {
      if (is_instance(link)) {
        parents[nodes + link_instance(link)] = node;
      } else if (!is_leaf(link) && link != kNoChild) {
        parents[link] = node;
      }
    }
  }
  return parents;
}

}  // namespace traces
