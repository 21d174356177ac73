#include "traces/accel/build.h"

#include <algorithm>
#include <cassert>
#include <numeric>
#include <span>
#include <utility>
#include <vector>

#include "traces/accel/build/bvh_build.h"
#include "traces/accel/build/collapse.h"
#include "traces/accel/build/flatten.h"
#include "traces/accel/build/material_tables.h"
#include "traces/accel/build/two_level.h"
#include "traces/accel/leaf_format.h"
#include "traces/accel/wide_format.h"
#include "traces/scene/bounds.h"

namespace traces {
namespace {

Bounds bounds_of(const MemoryImage& image, std::uint32_t leaf) {
  Bounds b;
  for (std::uint32_t i = leaf_first(leaf); i < leaf_first(leaf) + leaf_count(leaf); ++i) {
    const TriangleRecord& t = image.triangles[i];
    for (const glm::vec3& v : {t.v0, t.v1, t.v2}) b.add(v);
  }
  return b;
}

/// Returns the bounds of all triangles of an image.
Bounds triangle_bounds(const MemoryImage& image) {
  Bounds bounds;
  for (const TriangleRecord& t : image.triangles) {
    for (const glm::vec3& v : {t.v0, t.v1, t.v2}) bounds.add(v);
  }
  return bounds;
}

Bounds bounds_of(const NodeRecord& node) {
  return {{std::min(node.x[0], node.x[1]), std::min(node.y[0], node.y[1]), std::min(node.z[0], node.z[1])},
          {std::max(node.x[2], node.x[3]), std::max(node.y[2], node.y[3]), std::max(node.z[2], node.z[3])}};
}

/// Gives an image the nodes of a binary tree over its triangles, which are still in input order: collapsed if they are
/// to be wide. Returns the order of the triangles in leaves.
std::vector<std::uint32_t> set_nodes(FlatBvh&& bvh, const BvhConfig& config, MemoryImage& image) {
  std::vector<std::uint32_t> order = std::move(bvh.order);
  image.build_statistics = {std::move(bvh.statistics)};
  if (config.is_wide()) {
    bvh.order = std::move(order);
    WideBvh wide = collapse_tree(bvh, config, max_triangles_of_merged_leaf(config));
    image.wide_nodes = std::move(wide.nodes);
    image.wide_format = config.node_format();
    image.width = config.width;
    image.child_order = config.order;
    order = std::move(wide.order);
  } else {
    image.nodes = std::move(bvh.nodes);
  }
  if (config.leaf != LeafFormat::kTriangles) {
    image.leaf_format = config.leaf;
    arrange_leaves(image.triangles, triangle_leaves(image), config.leaf, order, image.begins_record);
  }
  return order;
}

/// Sets the bounds of a one-level image and rounds its boxes to the format of its nodes.
void finish_nodes(const BvhConfig& config, MemoryImage& image) {
  const Bounds bounds = triangle_bounds(image);
  if (!bounds.empty()) {
    image.lower = bounds.lower;
    image.upper = bounds.upper;
  }
  if (config.box_numbers() == BoxNumbers::kHybrid) round_boxes_to_grid(image);
  if (is_quantised(image.wide_format)) quantise_nodes(image.wide_nodes, image.wide_format);
}

MemoryImage build_one_level(const Scene& scene, const MaterialTables& materials, const BvhConfig& config,
                            unsigned threads, sim::Stop stop) {
  const std::vector<PlacedMesh> placed = placed_instances(scene);
  MemoryImage image;
  image.triangles = triangle_records(placed, materials);
  const std::vector<std::uint32_t> order =
      set_nodes(BvhBuilder(config, threads, stop).build_over(image.triangles), config, image);
  ShadingRecords shading = shading_records(placed, materials);
  image.attributes = std::move(shading.attributes);
  image.vertices = std::move(shading.vertices);
  reorder_records<TriangleRecord>(image.triangles, order);
  reorder_records<AttributeRecord>(image.attributes, order);
  if (!image.vertices.empty()) reorder_records<VertexRecord>(image.vertices, order);
  finish_nodes(config, image);
  return image;
}

/// Builds a memory image. `earlier`: an image of the same scene in another pose, whose mip levels are moved; may be
/// null.
MemoryImage build_image(const Scene& scene, const BvhConfig& config, unsigned threads, sim::Stop stop, MipMaps mip_maps,
                        Roughness roughness, MemoryImage* earlier) {
  const bool has_mip_maps = mip_maps == MipMaps::kOn && !scene.textures.empty();
  MaterialTables materials = material_tables(scene, has_mip_maps, roughness);
  const bool levels = config.instances == InstanceLevels::kTwoLevel;
  MemoryImage image = levels ? build_two_levels(scene, materials, config, threads, stop)
                             : build_one_level(scene, materials, config, threads, stop);
  image.has_roughness = roughness == Roughness::kOn;
  image.textures = scene.textures;
  if (materials.needs_white) {
    image.white = static_cast<std::uint32_t>(image.textures.size());
    image.textures.push_back({.name = "white", .width = 1, .height = 1, .texels = {0xffffffffU}});
  }
  if (has_mip_maps) add_mip_levels(materials, image, earlier);
  image.materials = std::move(materials.records);
  image.details = std::move(materials.details);
  image.lights = scene.lights;
  image.background = scene.background;
  image.ambient = scene.ambient;
  image.layout = layout_of(counts_of(image), image, config);
  return image;
}

}  // namespace

MemoryImage build_memory_image(const Scene& scene, const BvhConfig& config, unsigned threads, sim::Stop stop,
                               MipMaps mip_maps, Roughness roughness) {
  return build_image(scene, config, threads, stop, mip_maps, roughness, nullptr);
}

MemoryImage reformat_tree(const MemoryImage& binary, const BvhConfig& config) {
  assert(!binary.is_wide() && !binary.grid && !binary.has_two_levels());
  MemoryImage image;
  image.triangles = binary.triangles;
  FlatBvh bvh{binary.nodes, std::vector<std::uint32_t>(binary.triangles.size()), binary.build_statistics.at(0)};
  std::iota(bvh.order.begin(), bvh.order.end(), 0U);
  reorder_records<TriangleRecord>(image.triangles, set_nodes(std::move(bvh), config, image));
  finish_nodes(config, image);
  image.layout = layout_of(counts_of(binary), image, config);
  return image;
}

namespace {

/// Recomputes the boxes of wide nodes. Exact bounds are kept apart from the planes, which the format may round.
void recompute_wide_boxes(MemoryImage& image, std::size_t first, std::size_t end) {
  std::vector<Bounds> exact(end - first);
  for (std::size_t i = end; i-- > first;) {
    WideNode& node = image.wide_nodes[i];
    Bounds& all = exact[i - first];
    for (std::uint32_t slot = 0; slot < kMaxWidth; ++slot) {
      const std::uint32_t link = node.child[slot];
      if (link == kNoChild) continue;
      const Bounds box = is_leaf(link) ? bounds_of(image, link) : exact[link - first];
      set_box(node, slot, box);
      all.add(box.lower);
      all.add(box.upper);
    }
  }
  if (is_quantised(image.wide_format)) {
    quantise_nodes(std::span(image.wide_nodes).subspan(first, end - first), image.wide_format);
  }
}

}  // namespace

/// Recomputes the boxes of BVH nodes in one backward pass. Nodes precede their children, so the boxes of the children
/// are known first.
void recompute_boxes(MemoryImage& image, std::size_t first, std::size_t end) {
  if (image.is_wide()) return recompute_wide_boxes(image, first, end);
  for (std::size_t i = end; i-- > first;) {
    NodeRecord& node = image.nodes[i];
    for (int c = 0; c < 2; ++c) {
      const std::uint32_t link = node.child[c];
      if (link == kNoChild) continue;
      set_box(node, c, is_leaf(link) ? bounds_of(image, link) : bounds_of(image.nodes[link]));
    }
  }
}

void refit_memory_image(const Scene& posed, MemoryImage& image) {
  const MaterialTables materials = material_tables(posed, image.has_mip_maps());
  const std::vector<PlacedMesh> placed = placed_instances(posed);
  const std::vector<TriangleRecord> triangles = triangle_records(placed, materials);
  assert(triangles.size() == image.triangles.size() && "a refit moves triangles, it does not add or remove any");
  for (TriangleRecord& t : image.triangles) t = triangles[t.source];
  const ShadingRecords shading = shading_records(placed, materials);
  for (std::size_t i = 0; i < image.triangles.size(); ++i) {
    const std::uint32_t source = image.triangles[i].source;
    image.attributes[i] = shading.attributes[source];
    if (!shading.vertices.empty()) image.vertices[i] = shading.vertices[source];
  }
  recompute_boxes(image, 0, image.node_count());
  if (!image.triangles.empty()) {
    const Bounds bounds = image.is_wide() ? triangle_bounds(image) : bounds_of(image.nodes.front());
    image.lower = bounds.lower;
    image.upper = bounds.upper;
  }
  if (image.grid) round_boxes_to_grid(image);
  if (image.leaf_format != LeafFormat::kTriangles) {
    cut_records(image.triangles, triangle_leaves(image), image.leaf_format, image.begins_record);
  }
  image.lights = posed.lights;
}

void update_memory_image(const Scene& posed, const BvhConfig& config, unsigned threads, MemoryImage& image,
                         sim::Stop stop) {
  if (config.instances == InstanceLevels::kTwoLevel) {
    if (update_two_levels(posed, config, threads, image, stop)) return;
  } else if (config.update == BvhUpdate::kRefit) {
    refit_memory_image(posed, image);
    // Triangles that have moved may need other records.
    if (image.leaf_format != LeafFormat::kTriangles) image.layout = layout_of(counts_of(image), image, config);
    return;
  }
  const MipMaps mip_maps = image.has_mip_maps() ? MipMaps::kOn : MipMaps::kOff;
  const Roughness roughness = image.has_roughness ? Roughness::kOn : Roughness::kOff;
  image = build_image(posed, config, threads, stop, mip_maps, roughness, &image);
}

}  // namespace traces
