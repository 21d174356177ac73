#include "traces/accel/memory_image.h"

#include <utility>

#include <glm/geometric.hpp>

#include "traces/accel/build.h"
#include "traces/accel/bvh_build.h"
#include "traces/accel/flatten.h"
#include "traces/accel/material_tables.h"
#include "traces/scene/bounds.h"

namespace traces {
namespace {

constexpr std::uint64_t aligned(std::uint64_t at) { return (at + 63) & ~std::uint64_t{63}; }

/// One array behind the other, each on a line of its own: nodes, triangles, attributes, materials, textures, frame.
/// What the scene does not need takes no memory.
Layout place(const MemoryImage& image) {
  Layout at;
  std::uint64_t next = 0;
  const auto reserve = [&](std::uint64_t bytes) {
    const std::uint64_t base = next;
    next = aligned(next + bytes);
    return base;
  };
  at.nodes = reserve(image.nodes.size() * sizeof(NodeRecord));
  at.triangles = reserve(image.triangles.size() * sizeof(TriangleRecord));
  at.attributes = reserve(image.attributes.size() * sizeof(AttributeRecord));
  at.vertices = reserve(image.vertices.size() * sizeof(VertexRecord));
  at.materials = reserve(image.materials.size() * sizeof(MaterialRecord));
  at.details = reserve(image.details.size() * sizeof(MaterialDetailRecord));
  for (const Texture& texture : image.textures) {
    const std::uint32_t per_row = (texture.width + 3) / 4;
    at.textures.push_back({reserve(std::uint64_t{per_row} * ((texture.height + 3) / 4) * 64), per_row});
  }
  at.frame_buffer = at.end = next;
  return at;
}

}  // namespace

float MemoryImage::diagonal() const { return glm::length(upper - lower); }

MemoryImage build_memory_image(const Scene& scene, const BvhConfig& config, unsigned threads) {
  MaterialTables materials = material_tables(scene);
  const FlatTriangles flat = flatten(scene, materials);
  PlacedBvh bvh = build_bvh(flat.triangles, config, threads);

  MemoryImage image;
  image.nodes = std::move(bvh.nodes);
  image.triangles.reserve(bvh.order.size());
  image.attributes.reserve(bvh.order.size());
  Bounds bounds;
  for (const std::uint32_t source : bvh.order) {
    const TriangleRecord& t = flat.triangles[source];
    image.triangles.push_back(t);
    image.attributes.push_back(flat.attributes[source]);
    if (!flat.vertices.empty()) image.vertices.push_back(flat.vertices[source]);
    for (const glm::vec3& v : {t.v0, t.v1, t.v2}) bounds.add(v);
  }
  if (!bounds.empty()) {
    image.lower = bounds.lower;
    image.upper = bounds.upper;
  }
  image.textures = scene.textures;
  if (materials.needs_white) {
    image.white = static_cast<std::uint32_t>(image.textures.size());
    image.textures.push_back({.name = "white", .width = 1, .height = 1, .texels = {0xffffffffU}});
  }
  image.materials = std::move(materials.records);
  image.details = std::move(materials.details);
  image.lights = scene.lights;
  image.background = scene.background;
  image.ambient = scene.ambient;
  image.layout = place(image);
  return image;
}

std::vector<std::uint32_t> parents_of(const MemoryImage& image) {
  std::vector<std::uint32_t> parents(image.nodes.size());
  for (std::uint32_t node = 0; node < image.nodes.size(); ++node) {
    for (const std::uint32_t link : image.nodes[node].child) {
      if (!is_leaf(link) && link != kNoChild) parents[link] = node;
    }
  }
  return parents;
}

}  // namespace traces
