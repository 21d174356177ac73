#include "traces/accel/flatten.h"

#include <algorithm>
#include <array>
#include <string>

#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/vec4.hpp>

#include "sim/error.h"
#include "traces/walk.h"

namespace traces {
namespace {

/// Carries normals to world space: the transposed inverse times |determinant|, which exists for flat instances too.
glm::mat3 normal_matrix(const glm::mat4& to_world) {
  const glm::vec3 x(to_world[0]), y(to_world[1]), z(to_world[2]);
  const glm::mat3 cofactors(glm::cross(y, z), glm::cross(z, x), glm::cross(x, y));
  return glm::dot(x, glm::cross(y, z)) < 0 ? -cofactors : cofactors;
}

/// `v` at unit length, or `otherwise` if it has no direction.
glm::vec3 unit_or(const glm::vec3& v, const glm::vec3& otherwise) {
  const glm::dvec3 wide(v);
  const double length = glm::length(wide);
  return length > 0 ? glm::vec3(wide / length) : otherwise;
}

bool has_area(const TriangleRecord& t) {
  const glm::dvec3 v0(t.v0);
  return glm::cross(glm::dvec3(t.v1) - v0, glm::dvec3(t.v2) - v0) != glm::dvec3(0);
}

void check(const Mesh& mesh, std::size_t materials) {
  const auto refuse = [&](const std::string& what) { throw sim::InputError("mesh '" + mesh.name + "': " + what); };
  if (mesh.material >= materials) {
    refuse("material " + std::to_string(mesh.material) + " of " + std::to_string(materials));
  }
  if (!mesh.normals.empty() && mesh.normals.size() != mesh.positions.size()) {
    refuse("normals must be as many as positions, or none");
  }
  if (!mesh.uvs.empty() && mesh.uvs.size() != mesh.positions.size()) {
    refuse("texture coordinates must be as many as positions, or none");
  }
  for (const auto& corners : mesh.triangles) {
    if (std::ranges::max(corners) >= mesh.positions.size()) refuse("a triangle names a vertex that is not there");
  }
}

void append(const Mesh& mesh, const glm::mat4& to_world, std::uint32_t object, FlatTriangles& out) {
  std::vector<glm::vec3> positions(mesh.positions.size());
  // Adding nothing makes zeros positive: boxes do not depend on the order in which they are put together.
  std::ranges::transform(mesh.positions, positions.begin(),
                         [&](const glm::vec3& p) { return glm::vec3(to_world * glm::vec4(p, 1)) + 0.0F; });
  const glm::mat3 to_world_normal = normal_matrix(to_world);
  for (const auto& corners : mesh.triangles) {
    TriangleRecord triangle{positions[corners[0]], positions[corners[1]],
                            positions[corners[2]], object,
                            mesh.material,         static_cast<std::uint32_t>(out.triangles.size())};
    if (!has_area(triangle)) triangle.v1 = triangle.v2 = triangle.v0;
    out.triangles.push_back(triangle);

    const glm::vec3& p0 = mesh.positions[corners[0]];
    const glm::vec3 face = glm::cross(mesh.positions[corners[1]] - p0, mesh.positions[corners[2]] - p0);
    const glm::vec3 flat = unit_or(to_world_normal * unit_or(face, glm::vec3(0, 1, 0)), glm::vec3(0, 1, 0));
    AttributeRecord attributes{};
    for (int i = 0; i < 3; ++i) {
      const std::uint32_t vertex = corners[static_cast<std::size_t>(i)];
      attributes.normal[i] = mesh.normals.empty() ? flat : unit_or(to_world_normal * mesh.normals[vertex], flat);
      attributes.uv[i] = mesh.uvs.empty() ? glm::vec2(0) : mesh.uvs[vertex];
    }
    attributes.material = mesh.material;
    out.attributes.push_back(attributes);
  }
}

}  // namespace

FlatTriangles flatten(const Scene& scene) {
  for (const Mesh& mesh : scene.meshes) check(mesh, std::max<std::size_t>(scene.materials.size(), 1));
  std::size_t count = 0;
  for (const Instance& instance : scene.instances) {
    if (instance.mesh >= scene.meshes.size()) throw sim::InputError("an instance names a mesh that is not there");
    count += scene.meshes[instance.mesh].triangles.size();
  }
  if (count > kMaxTriangles) {
    throw sim::InputError("the scene has " + std::to_string(count) + " triangles; at most " +
                          std::to_string(kMaxTriangles) + " are allowed");
  }
  FlatTriangles out;
  out.triangles.reserve(count);
  out.attributes.reserve(count);
  for (std::uint32_t i = 0; i < scene.instances.size(); ++i) {
    append(scene.meshes[scene.instances[i].mesh], scene.instances[i].to_world, i, out);
  }
  return out;
}

}  // namespace traces
