#include "traces/scene/normals.h"

#include <utility>

#include <glm/geometric.hpp>

#include "traces/scene/select_vertices.h"

namespace traces {
namespace {

/// Returns a triangle's normal; +y if it has no area. Computed in double for tiny and huge triangles.
glm::vec3 geometric_normal(const glm::vec3& a, const glm::vec3& b, const glm::vec3& c) {
  const glm::dvec3 normal = glm::cross(glm::dvec3(b) - glm::dvec3(a), glm::dvec3(c) - glm::dvec3(a));
  const double length = glm::length(normal);
  return length > 0 ? glm::vec3(normal / length) : glm::vec3(0, 1, 0);
}

}  // namespace

std::vector<std::uint32_t> flatten_normals(Mesh& mesh) {
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

}  // namespace traces
