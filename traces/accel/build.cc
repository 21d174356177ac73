#include "traces/accel/build.h"

#include <algorithm>
#include <cassert>
#include <utility>

#include "traces/accel/build/bvh_build.h"
#include "traces/accel/build/flatten.h"
#include "traces/accel/build/material_tables.h"
#include "traces/accel/build/two_level.h"
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

Bounds bounds_of(const NodeRecord& node) {
  return {{std::min(node.x[0], node.x[1]), std::min(node.y[0], node.y[1]), std::min(node.z[0], node.z[1])},
          {std::max(node.x[2], node.x[3]), std::max(node.y[2], node.y[3]), std::max(node.z[2], node.z[3])}};
}

MemoryImage build_one_level(const Scene& scene, const MaterialTables& materials, const BvhConfig& config,
                            unsigned threads, sim::Stop stop) {
  const std::vector<PlacedMesh> placed = placed_instances(scene);
  MemoryImage image;
  image.triangles = triangle_records(placed, materials);
  FlatBvh bvh = BvhBuilder(config, threads, stop).build_over(image.triangles);
  image.nodes = std::move(bvh.nodes);
  ShadingRecords shading = shading_records(placed, materials);
  image.attributes = std::move(shading.attributes);
  image.vertices = std::move(shading.vertices);
  reorder_records<TriangleRecord>(image.triangles, bvh.order);
  reorder_records<AttributeRecord>(image.attributes, bvh.order);
  if (!image.vertices.empty()) reorder_records<VertexRecord>(image.vertices, bvh.order);
  Bounds bounds;
  for (const TriangleRecord& t : image.triangles) {
    for (const glm::vec3& v : {t.v0, t.v1, t.v2}) bounds.add(v);
  }
  if (!bounds.empty()) {
    image.lower = bounds.lower;
    image.upper = bounds.upper;
  }
  if (config.numbers == BoxNumbers::kHybrid) round_boxes_to_grid(image);
  return image;
}

}  // namespace

MemoryImage build_memory_image(const Scene& scene, const BvhConfig& config, unsigned threads, sim::Stop stop,
                               MipMaps mip_maps) {
  const bool has_mip_maps = mip_maps == MipMaps::kOn && !scene.textures.empty();
  MaterialTables materials = material_tables(scene, has_mip_maps);
  const bool levels = config.instances == InstanceLevels::kTwoLevel;
  MemoryImage image = levels ? build_two_levels(scene, materials, config, threads, stop)
                             : build_one_level(scene, materials, config, threads, stop);
  image.textures = scene.textures;
  if (materials.needs_white) {
    image.white = static_cast<std::uint32_t>(image.textures.size());
    image.textures.push_back({.name = "white", .width = 1, .height = 1, .texels = {0xffffffffU}});
  }
  if (has_mip_maps) add_mip_levels(materials, image);
  image.materials = std::move(materials.records);
  image.details = std::move(materials.details);
  image.lights = scene.lights;
  image.background = scene.background;
  image.ambient = scene.ambient;
  image.layout = layout_of(counts_of(image), image.nodes, config);
  return image;
}

/// Recomputes the boxes of BVH nodes in one backward pass. Nodes precede their children, so the boxes of the children
/// are known first.
void recompute_boxes(MemoryImage& image, std::size_t first, std::size_t end) {
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
  recompute_boxes(image, 0, image.nodes.size());
  if (!image.triangles.empty()) {
    const Bounds bounds = bounds_of(image.nodes.front());
    image.lower = bounds.lower;
    image.upper = bounds.upper;
  }
  if (image.grid) round_boxes_to_grid(image);
  image.lights = posed.lights;
}

void update_memory_image(const Scene& posed, const BvhConfig& config, unsigned threads, MemoryImage& image,
                         sim::Stop stop) {
  if (config.instances == InstanceLevels::kTwoLevel) {
    if (update_two_levels(posed, config, threads, image, stop)) return;
  } else if (config.update == BvhUpdate::kRefit) {
    refit_memory_image(posed, image);
    return;
  }
  const MipMaps mip_maps = image.has_mip_maps() ? MipMaps::kOn : MipMaps::kOff;
  image = build_memory_image(posed, config, threads, stop, mip_maps);
}

}  // namespace traces
