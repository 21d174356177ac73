#include "traces/scene/normals_tangents.h"

#include <algorithm>
#include <array>
#include <cfloat>
#include <cmath>
#include <numeric>
#include <tuple>
#include <utility>

#include <glm/geometric.hpp>

namespace traces {
namespace {

template <class T>
void select_values(std::vector<T>& values, const std::vector<std::uint32_t>& from) {
  if (values.empty()) return;
  std::vector<T> selected;
  selected.reserve(from.size());
  for (const std::uint32_t i : from) selected.push_back(values[i]);
  values = std::move(selected);
}

}  // namespace

void select_vertices(Mesh& mesh, const std::vector<std::uint32_t>& from) {
  select_values(mesh.positions, from);
  select_values(mesh.normals, from);
  select_values(mesh.uvs, from);
  select_values(mesh.second_uvs, from);
  select_values(mesh.tangents, from);
  select_values(mesh.colours, from);
}

namespace {

/// Returns a triangle's unit normal; +y if it has no area. Uses double precision, because the area of a tiny or huge
/// triangle exceeds float's range.
glm::vec3 geometric_normal(const glm::vec3& a, const glm::vec3& b, const glm::vec3& c) {
  const glm::dvec3 normal = glm::cross(glm::dvec3(b) - glm::dvec3(a), glm::dvec3(c) - glm::dvec3(a));
  const double length = glm::length(normal);
  return length > 0 ? glm::vec3(normal / length) : glm::vec3(0, 1, 0);
}

}  // namespace

std::vector<std::uint32_t> make_flat_normals(Mesh& mesh) {
  std::vector<std::uint32_t> from;
  std::vector<glm::vec3> normals;
  from.reserve(mesh.triangles.size() * 3);
  normals.reserve(mesh.triangles.size() * 3);
  for (auto& triangle : mesh.triangles) {
    const glm::vec3 normal =
        geometric_normal(mesh.positions[triangle[0]], mesh.positions[triangle[1]], mesh.positions[triangle[2]]);
    for (std::uint32_t& vertex : triangle) {
      from.push_back(vertex);
      normals.push_back(normal);
      vertex = static_cast<std::uint32_t>(from.size() - 1);
    }
  }
  select_vertices(mesh, from);
  mesh.normals = std::move(normals);
  return from;
}

std::vector<glm::vec3> triangle_normals(const Mesh& mesh) {
  std::vector<glm::vec3> normals(mesh.positions.size(), glm::vec3(0, 1, 0));
  for (const auto& [a, b, c] : mesh.triangles) {
    normals[a] = normals[b] = normals[c] = geometric_normal(mesh.positions[a], mesh.positions[b], mesh.positions[c]);
  }
  return normals;
}

void repair_normals(Mesh& mesh) {
  bool has_null = false;
  for (glm::vec3& normal : mesh.normals) {
    const double length = glm::length(glm::dvec3(normal));
    normal = length > 0 ? glm::vec3(glm::dvec3(normal) / length) : glm::vec3(0);
    has_null = has_null || !(length > 0);
  }
  if (!has_null) return;
  for (const auto& triangle : mesh.triangles) {
    for (const std::uint32_t vertex : triangle) {
      if (mesh.normals[vertex] != glm::vec3(0)) continue;
      mesh.normals[vertex] =
          geometric_normal(mesh.positions[triangle[0]], mesh.positions[triangle[1]], mesh.positions[triangle[2]]);
    }
  }
  for (glm::vec3& normal : mesh.normals) {
    if (normal == glm::vec3(0)) normal = glm::vec3(0, 1, 0);
  }
}

namespace {

bool is_zero(double x) { return !(std::abs(x) > FLT_MIN); }

/// Returns the vector scaled to length 1; zero stays zero.
glm::dvec3 direction_of(const glm::dvec3& v) {
  const double length = glm::length(v);
  return is_zero(length) || !std::isfinite(length) ? glm::dvec3(0) : v / length;
}

/// Returns the part of `v` perpendicular to the normal, scaled to length 1, or zero if there is none.
glm::dvec3 perpendicular_part(const glm::dvec3& v, const glm::dvec3& normal) {
  return direction_of(v - normal * glm::dot(normal, v));
}

glm::dvec3 any_perpendicular(const glm::dvec3& normal) {
  const glm::dvec3 other = std::abs(normal.x) < 0.7 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0);
  return glm::normalize(other - normal * glm::dot(normal, other));
}

/// Directions of a triangle's texture coordinates, from which its tangents are computed.
struct TextureDirections {
  glm::dvec3 along_u{0};       ///< direction of increasing u, a unit vector
  bool is_degenerate = false;  ///< two corners have the same position
  bool has_direction = false;  ///< the triangle has an area in texture coordinates
  bool is_mirrored = false;    ///< the triangle shows a mirror image of the texture
};

class TangentBuilder {
 public:
  TangentBuilder(const Mesh& mesh, const std::vector<glm::vec2>& uvs)
      : mesh_(mesh), uvs_(uvs), group_of_(3 * mesh.triangles.size(), kNone) {
    weld_vertices();
    for (const auto& triangle : mesh.triangles) frames_.push_back(frame_of(triangle));
    find_neighbours();
    find_groups();
  }

  /// Returns the tangent of corner `i` of a triangle.
  glm::vec4 tangent_at(std::size_t triangle, std::size_t i) const {
    const std::uint32_t vertex = mesh_.triangles[triangle][i];
    std::uint32_t group = group_of_[3 * triangle + i];
    if (group == kNone) group = group_at_[vertex_of_[vertex]];
    return group == kNone ? any_tangent(vertex) : tangents_[group];
  }
  glm::vec4 any_tangent(std::uint32_t vertex) const {
    return glm::vec4(glm::dvec4(any_perpendicular(glm::dvec3(mesh_.normals[vertex])), 1));
  }

 private:
  using Corners = std::array<std::uint32_t, 3>;
  struct Edge {
    std::uint32_t low, high;  ///< indices of the edge's two vertices
    std::uint32_t number;     ///< 3 * triangle + number of the edge's first corner
    bool runs_up;             ///< the edge runs from `low` to `high`
  };

  Corners corners_of(std::size_t triangle) const {
    const auto& [a, b, c] = mesh_.triangles[triangle];
    return {vertex_of_[a], vertex_of_[b], vertex_of_[c]};
  }

  void weld_vertices() {
    const auto key = [&](std::uint32_t i) {
      const glm::vec3 &p = mesh_.positions[i], &n = mesh_.normals[i];
      return std::tuple(p.x, p.y, p.z, n.x, n.y, n.z, uvs_[i].x, uvs_[i].y);
    };
    std::vector<std::uint32_t> order(mesh_.positions.size());
    std::iota(order.begin(), order.end(), 0U);
    std::ranges::stable_sort(order, {}, key);
    vertex_of_.resize(order.size());
    for (std::size_t i = 0; i < order.size(); ++i) {
      const bool is_equal = i != 0 && key(order[i]) == key(order[i - 1]);
      vertex_of_[order[i]] = is_equal ? vertex_of_[order[i - 1]] : order[i];
    }
    group_at_.assign(order.size(), kNone);
  }

  TextureDirections frame_of(const Corners& triangle) const {
    const auto [a, b, c] = triangle;
    const glm::vec3 &p0 = mesh_.positions[a], &p1 = mesh_.positions[b], &p2 = mesh_.positions[c];
    TextureDirections frame;
    frame.is_degenerate = p0 == p1 || p1 == p2 || p2 == p0;
    const glm::dvec3 edge1 = glm::dvec3(p1) - glm::dvec3(p0), edge2 = glm::dvec3(p2) - glm::dvec3(p0);
    const glm::dvec2 uv1 = glm::dvec2(uvs_[b]) - glm::dvec2(uvs_[a]), uv2 = glm::dvec2(uvs_[c]) - glm::dvec2(uvs_[a]);
    const double area = uv1.x * uv2.y - uv2.x * uv1.y;
    if (is_zero(area) || !std::isfinite(area)) return frame;
    frame.is_mirrored = area > 0;  // v grows downwards in the picture
    frame.along_u = direction_of((edge1 * uv2.y - edge2 * uv1.y) / area);
    const glm::dvec3 along_v = direction_of((edge2 * uv1.x - edge1 * uv2.x) / area);
    frame.has_direction = frame.along_u != glm::dvec3(0) && along_v != glm::dvec3(0);
    return frame;
  }

  /// Pairs triangle edges that run in opposite directions between the same vertices.
  void find_neighbours() {
    std::vector<Edge> edges;
    edges.reserve(group_of_.size());
    for (std::uint32_t t = 0; t < frames_.size(); ++t) {
      if (frames_[t].is_degenerate) continue;
      const Corners v = corners_of(t);
      for (std::uint32_t i = 0; i < 3; ++i) {
        const std::uint32_t from = v[i], to = v[(i + 1) % 3];
        edges.push_back({std::min(from, to), std::max(from, to), 3 * t + i, from < to});
      }
    }
    std::ranges::sort(edges, {}, [](const Edge& e) { return std::tuple(e.low, e.high, e.number); });
    neighbour_.assign(group_of_.size(), kNone);
    for (auto a = edges.begin(); a != edges.end(); ++a) {
      if (neighbour_[a->number] != kNone) continue;
      for (auto b = a + 1; b != edges.end() && b->low == a->low && b->high == a->high; ++b) {
        if (neighbour_[b->number] != kNone || a->runs_up == b->runs_up) continue;
        neighbour_[a->number] = b->number / 3;
        neighbour_[b->number] = a->number / 3;
        break;
      }
    }
  }

  void find_groups() {
    for (std::uint32_t corner = 0; corner < group_of_.size(); ++corner) {
      const TextureDirections& frame = frames_[corner / 3];
      if (frame.is_degenerate || !frame.has_direction || group_of_[corner] != kNone) continue;
      add_group(corner);
    }
  }

  /// Adds to a tangent group all triangle corners that shared edges connect to the corner `seed`.
  void add_group(std::uint32_t seed) {
    const std::uint32_t vertex = corners_of(seed / 3)[seed % 3];
    const bool is_mirrored = frames_[seed / 3].is_mirrored;
    const auto group = static_cast<std::uint32_t>(tangents_.size());
    const glm::dvec3 normal(mesh_.normals[vertex]);
    glm::dvec3 sum(0);
    open_.assign(1, seed / 3);
    while (!open_.empty()) {
      const std::uint32_t triangle = open_.back();
      open_.pop_back();
      const Corners v = corners_of(triangle);
      const auto i = static_cast<std::uint32_t>(std::ranges::find(v, vertex) - v.begin());
      std::uint32_t* const groups = &group_of_[std::size_t{3} * triangle];
      if (groups[i] != kNone) continue;
      TextureDirections& frame = frames_[triangle];
      // A triangle without a texture direction joins the first group that reaches it.
      const bool is_free = groups[0] == kNone && groups[1] == kNone && groups[2] == kNone;
      if (!frame.has_direction && is_free) frame.is_mirrored = is_mirrored;
      if (frame.is_mirrored != is_mirrored) continue;
      groups[i] = group;
      if (frame.has_direction) sum += perpendicular_part(frame.along_u, normal) * angle_at(v, i, normal);
      for (const std::uint32_t edge : {(i + 2) % 3, i}) {
        const std::uint32_t next = neighbour_[3 * triangle + edge];
        if (next != kNone) open_.push_back(next);
      }
    }
    const glm::dvec3 tangent = perpendicular_part(sum, normal);
    tangents_.push_back(tangent == glm::dvec3(0) ? any_tangent(vertex)
                                                 : glm::vec4(glm::dvec4(tangent, is_mirrored ? -1 : 1)));
    if (group_at_[vertex] == kNone) group_at_[vertex] = group;
  }

  /// Returns the angle of a triangle at its corner `i`, in the plane perpendicular to the normal.
  double angle_at(const Corners& v, std::uint32_t i, const glm::dvec3& normal) const {
    const auto edge_to = [&](std::uint32_t other) {
      return perpendicular_part(glm::dvec3(mesh_.positions[v[other]]) - glm::dvec3(mesh_.positions[v[i]]), normal);
    };
    return std::acos(std::clamp(glm::dot(edge_to((i + 1) % 3), edge_to((i + 2) % 3)), -1.0, 1.0));
  }

  const Mesh& mesh_;
  const std::vector<glm::vec2>& uvs_;
  std::vector<std::uint32_t> vertex_of_;   ///< for each vertex of the mesh, the first vertex equal to it
  std::vector<TextureDirections> frames_;  ///< texture directions of each triangle
  std::vector<std::uint32_t> neighbour_;   ///< for each edge, the triangle across it, or kNone
  std::vector<std::uint32_t> group_of_;    ///< for each corner of a triangle, its tangent group
  std::vector<std::uint32_t> group_at_;    ///< for each vertex, its first tangent group
  std::vector<glm::vec4> tangents_;        ///< tangent of each tangent group
  std::vector<std::uint32_t> open_;        ///< triangles that the current tangent group has reached
};

}  // namespace

std::vector<std::uint32_t> compute_tangents(Mesh& mesh, bool second) {
  const std::vector<glm::vec2>& given = second ? mesh.second_uvs : mesh.uvs;
  const std::vector<glm::vec2> none(given.empty() ? mesh.positions.size() : 0);
  const TangentBuilder builder(mesh, given.empty() ? none : given);

  const auto vertices = static_cast<std::uint32_t>(mesh.positions.size());
  std::vector<std::uint32_t> from(vertices), next_copy(vertices, kNone);
  std::iota(from.begin(), from.end(), 0U);
  std::vector<glm::vec4> tangents(vertices, glm::vec4(0));
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto corners = mesh.triangles[t];
    for (std::size_t i = 0; i < 3; ++i) {
      const glm::vec4 tangent = builder.tangent_at(t, i);
      std::uint32_t vertex = corners[i];
      if (tangents[vertex] == glm::vec4(0)) tangents[vertex] = tangent;
      while (tangents[vertex] != tangent) {
        if (next_copy[vertex] == kNone) {
          next_copy[vertex] = static_cast<std::uint32_t>(from.size());
          from.push_back(corners[i]);
          next_copy.push_back(kNone);
          tangents.push_back(tangent);
        }
        vertex = next_copy[vertex];
      }
      mesh.triangles[t][i] = vertex;
    }
  }
  for (std::uint32_t v = 0; v < vertices; ++v) {
    if (tangents[v] == glm::vec4(0)) tangents[v] = builder.any_tangent(v);
  }
  if (from.size() > vertices) select_vertices(mesh, from);
  mesh.tangents = std::move(tangents);
  return from;
}

}  // namespace traces
