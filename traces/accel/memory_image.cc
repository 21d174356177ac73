#include "traces/accel/memory_image.h"

#include <algorithm>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "traces/accel/build.h"
#include "traces/accel/bvh_build.h"
#include "traces/accel/flatten.h"
#include "traces/scene/bounds.h"

namespace traces {
namespace {

constexpr std::uint64_t aligned(std::uint64_t at) { return (at + 63) & ~std::uint64_t{63}; }

/// One array behind the other, each on a line of its own: nodes, triangles, attributes, materials, textures, frame.
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
  at.materials = reserve(image.materials.size() * sizeof(MaterialRecord));
  for (const Texture& texture : image.textures) {
    const std::uint32_t per_row = (texture.width + 3) / 4;
    at.textures.push_back({reserve(std::uint64_t{per_row} * ((texture.height + 3) / 4) * 64), per_row});
  }
  at.frame_buffer = at.end = next;
  return at;
}

MaterialRecord record_of(const Material& m) {
  return {m.base_colour, m.mirror, m.mirror_tint, m.transmission, m.emission, m.ior, m.base_texture.texture, {}};
}

/// Makes record i what record order[i] was, without a second array: along the cycles of the permutation.
template <class Record>
void reorder(std::vector<Record>& records, const std::vector<std::uint32_t>& order) {
  std::vector<bool> done(records.size(), false);
  for (std::uint32_t start = 0; start < order.size(); ++start) {
    if (done[start]) continue;
    const Record first = records[start];
    std::uint32_t to = start;
    for (std::uint32_t from = order[to]; from != start; to = from, from = order[to]) {
      records[to] = records[from];
      done[to] = true;
    }
    records[to] = first;
    done[to] = true;
  }
}

}  // namespace

float MemoryImage::diagonal() const { return glm::length(upper - lower); }

MemoryImage build_memory_image(const Scene& scene, const BvhConfig& config, unsigned threads) {
  FlatTriangles flat = flatten(scene);
  PlacedBvh bvh = build_bvh(flat.triangles, config, threads);

  MemoryImage image;
  image.nodes = std::move(bvh.nodes);
  image.triangles = std::move(flat.triangles);
  image.attributes = std::move(flat.attributes);
  reorder(image.triangles, bvh.order);
  reorder(image.attributes, bvh.order);
  Bounds bounds;
  for (const TriangleRecord& t : image.triangles) {
    for (const glm::vec3& v : {t.v0, t.v1, t.v2}) bounds.add(v);
  }
  if (!bounds.empty()) {
    image.lower = bounds.lower;
    image.upper = bounds.upper;
  }
  std::ranges::transform(scene.materials, std::back_inserter(image.materials), record_of);
  if (image.materials.empty()) image.materials.push_back(record_of(Material{}));
  image.textures = scene.textures;
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
