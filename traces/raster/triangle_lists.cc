#include "traces/raster/triangle_lists.h"

#include <algorithm>
#include <bit>
#include <numeric>
#include <unordered_map>

#include <fmt/format.h>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>

#include "sim/error.h"
#include "sim/hash.h"

namespace traces {

namespace {

/// A vertex position as bits. Positions that compare equal but differ in a bit are different vertices.
using Key = std::array<std::uint32_t, 3>;
Key vertex_key(const glm::vec3& p) {
  return {std::bit_cast<std::uint32_t>(p.x), std::bit_cast<std::uint32_t>(p.y), std::bit_cast<std::uint32_t>(p.z)};
}
struct KeyHash {
  std::size_t operator()(const Key& key) const { return sim::hash(key[0], key[1], key[2]); }
};

/// Transforms points from a mesh's space to the world.
class ToWorld {
 public:
  explicit ToWorld(const InstanceRecord& instance) {
    glm::dmat3 to_object;
    for (int row = 0; row < 3; ++row) {
      for (int column = 0; column < 3; ++column) to_object[column][row] = instance.to_object[row][column];
      offset_[row] = instance.to_object[row][3];
    }
    to_world_ = glm::inverse(to_object);
  }
  glm::dvec3 operator()(const glm::vec3& p) const { return to_world_ * (glm::dvec3(p) - offset_); }

 private:
  glm::dmat3 to_world_{1};
  glm::dvec3 offset_{0};
};

/// Returns the flag of a triangle's culled face as seen in world space, where a mirrored instance swaps the two faces.
std::uint32_t culled_face(const TriangleRecord& triangle, bool is_mirrored) {
  const std::uint32_t missing = triangle.material & (kNoClockwise | kNoCounterClockwise);
  return missing != 0 && is_mirrored ? missing ^ (kNoClockwise | kNoCounterClockwise) : missing;
}

/// Numbers the vertices of triangles: equal positions share a number, and each new position gets the next one.
class Welder {
 public:
  explicit Welder(RasterGeometry& geometry) : geometry_(geometry) {}

  template <class ToSpace>
  void weld_triangles(const MemoryImage& image, std::uint32_t first, std::uint32_t count, std::uint32_t instance,
                      bool is_mirrored, ToSpace&& in_world) {
    numbers_.clear();  // instances share no vertices, because their world positions differ
    numbers_.reserve(count);
    for (std::uint32_t t = first; t < first + count; ++t) {
      const TriangleRecord& record = image.triangles[t];
      RasterGeometry::Triangle triangle{{}, t, instance, culled_face(record, is_mirrored)};
      std::size_t corner = 0;
      for (const glm::vec3* p : {&record.v0, &record.v1, &record.v2}) {
        const auto next = static_cast<std::uint32_t>(geometry_.vertices.size());
        const auto [at, is_new] = numbers_.try_emplace(vertex_key(*p), next);
        if (is_new) geometry_.vertices.push_back(in_world(*p));
        triangle.vertices[corner++] = at->second;
      }
      geometry_.triangles.push_back(triangle);
    }
  }

 private:
  RasterGeometry& geometry_;
  std::unordered_map<Key, std::uint32_t, KeyHash> numbers_;  // only looked up, because its order varies between hosts
};

}  // namespace

RasterGeometry raster_geometry(const MemoryImage& image) {
  RasterGeometry geometry;
  Welder welder(geometry);
  const auto as_it_is = [](const glm::vec3& p) { return glm::dvec3(p); };
  if (!image.has_two_levels()) {
    geometry.triangles.reserve(image.triangles.size());
    welder.weld_triangles(image, 0, static_cast<std::uint32_t>(image.triangles.size()), kNone, false, as_it_is);
    return geometry;
  }
  for (std::uint32_t i = 0; i < image.instances.size(); ++i) {
    if (image.tree_of[i] == kNone) continue;
    const ObjectTree& tree = image.trees[image.tree_of[i]];
    if (tree.in_world) {
      welder.weld_triangles(image, tree.first_triangle, tree.triangles, i, false, as_it_is);
    } else {
      const bool is_mirrored = image.instances[i].handedness < 0;
      welder.weld_triangles(image, tree.first_triangle, tree.triangles, i, is_mirrored, ToWorld(image.instances[i]));
    }
  }
  return geometry;
}

namespace {

/// Largest number of entries of all triangle lists together, which take 1 GiB.
constexpr std::uint64_t kMostEntries = 1U << 28;

}  // namespace

TriangleLists::TriangleLists(const RasterGeometry& geometry, const RasterView& view, double near, std::uint32_t side)
    : geometry_(geometry),
      view_(view),
      near_(near),
      side_(side),
      across_((view.width() + side - 1) / side),
      down_((view.height() + side - 1) / side),
      begin_(std::size_t{list_count()} + 1) {
  const auto triangles = static_cast<std::uint32_t>(geometry.triangles.size());
  std::uint64_t entries = 0;
  for (std::uint32_t t = 0; t < triangles; ++t) {
    for_each_list(t, [&](std::uint32_t list) {
      begin_[list + 1] += 1;
      entries += 1;
    });
    if (entries > kMostEntries) {
      throw sim::InputError(
          fmt::format("render.primary: raster: lists of triangles take more than {} entries; allowed: a larger "
                      "render.tile, a smaller resolution, or rays",
                      kMostEntries));
    }
  }
  std::partial_sum(begin_.begin(), begin_.end(), begin_.begin());
  entries_.resize(begin_.back());
  std::vector<std::uint32_t> next(begin_.begin(), begin_.end() - 1);
  for (std::uint32_t t = 0; t < triangles; ++t)
    for_each_list(t, [&](std::uint32_t list) { entries_[next[list]++] = t; });
}

std::uint32_t TriangleLists::list_number_at(const glm::dvec2& point) const {
  const auto part = [&](double pixels, std::uint32_t parts) {
    return pixels <= 0 ? 0U : std::min(parts - 1, static_cast<std::uint32_t>(pixels / side_));
  };
  return part(point.y, down_) * across_ + part(point.x, across_);
}

std::array<Projected, 3> TriangleLists::project_corners(std::uint32_t triangle) const {
  const auto& v = geometry_.triangles[triangle].vertices;
  return {view_.project_point(geometry_.vertices[v[0]]), view_.project_point(geometry_.vertices[v[1]]),
          view_.project_point(geometry_.vertices[v[2]])};
}

}  // namespace traces
