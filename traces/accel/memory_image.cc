#include "traces/accel/memory_image.h"

#include <algorithm>
#include <utility>

#include <glm/geometric.hpp>

#include "traces/accel/bvh_config.h"
#include "traces/accel/tree_places.h"

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
Layout layout_of(const ImageCounts& counts, const MemoryImage& image, const BvhConfig& config) {
  Layout at;
  at.node_bytes = config.is_wide() ? wide_node_bytes(config.node_format(), config.width)
                                   : node_bytes(config.box_numbers(), config.boxes);
  if (config.boxes == BoxRecords::kSingle) at.single_boxes = place_single_boxes(image.nodes);
  at.triangle_bytes = leaf_record_bytes(config);
  at.separate_labels = at.triangle_bytes == Layout::kVerticesBytes || config.leaf == LeafFormat::kBlock128;
  TreePlaces tree = place_tree(counts, image, config);
  at.node_places = std::move(tree.nodes);
  at.triangle_places = std::move(tree.triangles);
  at.instance_places = std::move(tree.instances);
  at.leaf_bytes = tree.leaf_bytes;
  at.tree_bytes = tree.node_bytes + (tree.one_array ? 0 : counts.instances * sizeof(InstanceRecord) + tree.leaf_bytes);
  std::uint64_t next = 0;
  const auto reserve = [&](std::uint64_t bytes) {
    const std::uint64_t base = next;
    next = align_to_line(next + bytes);
    return base;
  };
  at.nodes = at.instances = at.triangles = reserve(tree.node_bytes);
  if (!tree.one_array) {
    at.instances = reserve(counts.instances * sizeof(InstanceRecord));
    at.triangles = reserve(tree.leaf_bytes);
  }
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
  if (is_wide()) return std::uint64_t{layout.node_bytes} * wide_nodes.size();
  const BoxRecords boxes = layout.single_boxes.empty() ? BoxRecords::kPair : BoxRecords::kSingle;
  return layout.node_bytes * node_records(nodes.size(), boxes, 1 + trees.size());
}

Bounds tree_bounds(const MemoryImage& image, std::uint32_t root) {
  if (!image.is_wide()) {
    const NodeRecord& node = image.nodes[root];
    return {{std::min(node.x[0], node.x[1]), std::min(node.y[0], node.y[1]), std::min(node.z[0], node.z[1])},
            {std::max(node.x[2], node.x[3]), std::max(node.y[2], node.y[3]), std::max(node.z[2], node.z[3])}};
  }
  Bounds bounds;
  for (int axis = 0; axis < 3; ++axis) {
    const auto& [lower, upper] = image.wide_nodes[root].planes[axis];
    bounds.lower[axis] = *std::ranges::min_element(lower);
    bounds.upper[axis] = *std::ranges::max_element(upper);
  }
  return bounds;
}

std::vector<std::uint32_t> parent_indices(const MemoryImage& image) {
  const auto nodes = static_cast<std::uint32_t>(image.node_count());
  std::vector<std::uint32_t> parents(nodes + image.instances.size());
  for (const ObjectTree& tree : image.trees) parents[tree.first_node] = tree.first_node;
  for (std::uint32_t node = 0; node < nodes; ++node) {
    for (const std::uint32_t link : image.links_of(node)) {
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
