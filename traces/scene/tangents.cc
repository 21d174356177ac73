#include "traces/scene/tangents.h"

#include <cmath>

#include <glm/geometric.hpp>

namespace traces {
namespace {

glm::dvec3 perpendicular(const glm::dvec3& normal) {
  const glm::dvec3 other = std::abs(normal.x) < 0.7 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0);
  return glm::normalize(other - normal * glm::dot(normal, other));
}

/// Unit length and perpendicular to the normal, or null.
glm::dvec3 orthogonalised(const glm::dvec3& tangent, const glm::dvec3& normal) {
  constexpr double kLeast = 1e-6;  // share of its length that must be left beside the normal
  const double whole = glm::length(tangent);
  const glm::dvec3 rest = tangent - normal * glm::dot(normal, tangent);
  const double length = glm::length(rest);
  return length > kLeast * whole && std::isfinite(length) ? rest / length : glm::dvec3(0);
}

}  // namespace

void compute_tangents(Mesh& mesh, const std::vector<glm::vec2>& uvs) {
  struct Sum {
    glm::dvec3 along_u{0}, along_v{0};
  };
  std::vector<Sum> sums(mesh.positions.size());
  for (const auto& triangle : mesh.triangles) {
    if (uvs.empty()) break;
    const auto [a, b, c] = triangle;
    const glm::dvec3 edge1 = glm::dvec3(mesh.positions[b]) - glm::dvec3(mesh.positions[a]);
    const glm::dvec3 edge2 = glm::dvec3(mesh.positions[c]) - glm::dvec3(mesh.positions[a]);
    const glm::dvec2 uv1 = glm::dvec2(uvs[b]) - glm::dvec2(uvs[a]), uv2 = glm::dvec2(uvs[c]) - glm::dvec2(uvs[a]);
    const double area = uv1.x * uv2.y - uv2.x * uv1.y;
    if (area == 0 || !std::isfinite(area)) continue;
    const glm::dvec3 along_u = (edge1 * uv2.y - edge2 * uv1.y) / area;
    const glm::dvec3 along_v = (edge2 * uv1.x - edge1 * uv2.x) / area;
    for (const std::uint32_t vertex : triangle) {
      sums[vertex].along_u += along_u;
      sums[vertex].along_v += along_v;
    }
  }
  mesh.tangents.resize(mesh.positions.size());
  for (std::size_t i = 0; i < sums.size(); ++i) {
    const glm::dvec3 normal(mesh.normals[i]);
    glm::dvec3 tangent = orthogonalised(sums[i].along_u, normal);
    if (tangent == glm::dvec3(0)) tangent = perpendicular(normal);
    const double sign = glm::dot(glm::cross(normal, tangent), sums[i].along_v) < 0 ? -1 : 1;
    mesh.tangents[i] = glm::vec4(glm::dvec4(tangent, sign));
  }
}

}  // namespace traces
