#include "traces/accel/build/flatten.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>
#include <glm/vec2.hpp>
#include <glm/vec4.hpp>

#include "sim/error.h"
#include "traces/walk.h"

namespace traces {
namespace {

/// Returns the matrix for normals: the transposed inverse times |determinant|. This matrix exists even if the instance
/// is flat.
glm::mat3 normal_matrix(const glm::mat4& to_world) {
  const glm::vec3 x(to_world[0]), y(to_world[1]), z(to_world[2]);
  const glm::mat3 cofactors(glm::cross(y, z), glm::cross(z, x), glm::cross(x, y));
  return glm::dot(x, glm::cross(y, z)) < 0 ? -cofactors : cofactors;
}

/// Returns `v` scaled to length 1, or `otherwise` if the length of `v` is 0.
glm::vec3 unit_vector_or(const glm::vec3& v, const glm::vec3& otherwise) {
  const glm::dvec3 wide(v);
  const double length = glm::length(wide);
  return length > 0 ? glm::vec3(wide / length) : otherwise;
}

bool has_area(const TriangleRecord& t) {
  const glm::dvec3 v0(t.v0);
  return glm::cross(glm::dvec3(t.v1) - v0, glm::dvec3(t.v2) - v0) != glm::dvec3(0);
}

void check_mesh(const Mesh& mesh, std::size_t materials) {
  const auto refuse = [&](const std::string& what) { throw sim::InputError("mesh '" + mesh.name + "': " + what); };
  if (mesh.material >= materials) {
    refuse("material " + std::to_string(mesh.material) + " of " + std::to_string(materials));
  }
  if (!mesh.normals.empty() && mesh.normals.size() != mesh.positions.size()) {
    refuse("normals must be as many as positions, or none");
  }
  const auto is_odd = [&](const auto& array) { return !array.empty() && array.size() != mesh.positions.size(); };
  if (is_odd(mesh.uvs) || is_odd(mesh.second_uvs)) refuse("texture coordinates must be as many as positions, or none");
  if (is_odd(mesh.tangents) || is_odd(mesh.colours)) {
    refuse("tangents and colours must be as many as positions, or none");
  }
  for (const auto& corners : mesh.triangles) {
    if (std::ranges::max(corners) >= mesh.positions.size()) refuse("a triangle names a vertex that is not there");
  }
}

/// Encodes x in [-1, 1] as the byte 128 + 127 * x.
std::uint32_t encode_signed_byte(float x) {
  return static_cast<std::uint32_t>(std::lround(127 * std::clamp(x, -1.0F, 1.0F)) + 128);
}

std::uint32_t packed_tangent(const glm::vec3& t, float sign) {
  return encode_signed_byte(t.x) | encode_signed_byte(t.y) << 8 | encode_signed_byte(t.z) << 16 |
         encode_signed_byte(sign) << 24;
}

std::uint32_t half_word(float x) { return static_cast<std::uint32_t>(std::lround(65535 * std::clamp(x, 0.0F, 1.0F))); }

/// Returns a triangle's vertex record. Missing data default to white, first texture coordinates, tangents of length 0.
VertexRecord vertex_record_of(const Mesh& mesh, const std::array<std::uint32_t, 3>& corners,
                              const glm::mat3& to_world) {
  const float handedness = glm::determinant(to_world) < 0 ? -1.0F : 1.0F;
  VertexRecord record{};
  for (std::size_t i = 0; i < 3; ++i) {
    const std::uint32_t vertex = corners[i];
    const std::vector<glm::vec2>& uvs = mesh.second_uvs.empty() ? mesh.uvs : mesh.second_uvs;
    record.uv[i] = uvs.empty() ? glm::vec2(0) : uvs[vertex];
    const glm::vec4 colour = mesh.colours.empty() ? glm::vec4(1) : mesh.colours[vertex];
    record.colour[i][0] = half_word(colour.x) | half_word(colour.y) << 16;
    record.colour[i][1] = half_word(colour.z) | half_word(colour.w) << 16;
    const glm::vec4 tangent = mesh.tangents.empty() ? glm::vec4(0) : mesh.tangents[vertex];
    record.tangent[i] =
        packed_tangent(unit_vector_or(to_world * glm::vec3(tangent), glm::vec3(0)), handedness * tangent.w);
  }
  return record;
}

/// Returns the texture density of a triangle: the square root of its area in texture coordinates divided by its area in
/// space. A triangle that shows only a point or line of the texture gets the smallest density, so that its texels are
/// not averaged.
float texture_density(const Mesh& mesh, const std::array<std::uint32_t, 3>& corners, const glm::mat3& to_space) {
  if (mesh.uvs.empty()) return kLeastDensity;
  const auto edge = [&](const auto& array, std::size_t i) { return array[corners[i]] - array[corners[0]]; };
  const glm::dvec2 s(edge(mesh.uvs, 1)), t(edge(mesh.uvs, 2));
  const glm::dvec3 a(to_space * edge(mesh.positions, 1)), b(to_space * edge(mesh.positions, 2));
  const double shown = std::abs(s.x * t.y - s.y * t.x), area = glm::length(glm::cross(a, b));
  if (!(shown > 0 && area > 0)) return kLeastDensity;
  return std::clamp(static_cast<float>(std::sqrt(shown / area)), kLeastDensity, kMostDensity);
}

void append_shading_records(const PlacedMesh& placed, const MaterialTables& materials, ShadingRecords& out) {
  const Mesh& mesh = *placed.mesh;
  const glm::mat3 normals_to_space = normal_matrix(placed.to_space);
  for (const auto& corners : mesh.triangles) {
    const glm::vec3& p0 = mesh.positions[corners[0]];
    const glm::vec3 face = glm::cross(mesh.positions[corners[1]] - p0, mesh.positions[corners[2]] - p0);
    const glm::vec3 flat =
        unit_vector_or(normals_to_space * unit_vector_or(face, glm::vec3(0, 1, 0)), glm::vec3(0, 1, 0));
    const float length = materials.needs_density ? texture_density(mesh, corners, glm::mat3(placed.to_space)) : 1.0F;
    AttributeRecord attributes{};
    for (int i = 0; i < 3; ++i) {
      const std::uint32_t vertex = corners[static_cast<std::size_t>(i)];
      const glm::vec3 unit =
          mesh.normals.empty() ? flat : unit_vector_or(normals_to_space * mesh.normals[vertex], flat);
      attributes.normal[i] = unit * length;
      attributes.uv[i] = mesh.uvs.empty() ? glm::vec2(0) : mesh.uvs[vertex];
    }
    attributes.material = mesh.material;
    out.attributes.push_back(attributes);
    if (materials.needs_vertices) out.vertices.push_back(vertex_record_of(mesh, corners, glm::mat3(placed.to_space)));
  }
}

std::size_t count_triangles(std::span<const PlacedMesh> placed) {
  std::size_t count = 0;
  for (const PlacedMesh& p : placed) count += p.mesh->triangles.size();
  return count;
}

/// Returns which face of a triangle is culled: the back face if the material is single-sided. Front faces have
/// counter-clockwise corners, or clockwise ones in a mirrored mesh (glTF).
std::uint32_t culled_face(const MaterialRecord& material, const glm::mat4& to_space) {
  if ((material.flags & kSingleSided) == 0) return 0;
  return glm::determinant(glm::dmat3(to_space)) < 0 ? kNoCounterClockwise : kNoClockwise;
}

}  // namespace

void check_meshes(const Scene& scene) {
  for (const Mesh& mesh : scene.meshes) check_mesh(mesh, std::max<std::size_t>(scene.materials.size(), 1));
  for (const Instance& instance : scene.instances) {
    if (instance.mesh >= scene.meshes.size()) throw sim::InputError("an instance names a mesh that is not there");
  }
}

void check_triangle_count(std::size_t triangles) {
  if (triangles <= kMaxTriangles) return;
  throw sim::InputError("the scene has " + std::to_string(triangles) + " triangles; at most " +
                        std::to_string(kMaxTriangles) + " are allowed");
}

std::vector<PlacedMesh> placed_instances(const Scene& scene) {
  check_meshes(scene);
  std::vector<PlacedMesh> placed;
  for (std::uint32_t i = 0; i < scene.instances.size(); ++i) {
    const Instance& instance = scene.instances[i];
    placed.push_back({&scene.meshes[instance.mesh], instance.to_world, object_id_of(instance, i)});
  }
  return placed;
}

void append_triangles(const PlacedMesh& placed, const MaterialTables& materials, std::size_t base,
                      std::vector<TriangleRecord>& out) {
  const Mesh& mesh = *placed.mesh;
  const MaterialRecord& record = materials.records[mesh.material];
  const std::uint32_t material = triangle_flags(record) | culled_face(record, placed.to_space) | mesh.material;
  std::vector<glm::vec3> positions(mesh.positions.size());
  // Adding 0 turns -0 into +0, so that boxes do not depend on the order in which they are merged.
  std::ranges::transform(mesh.positions, positions.begin(),
                         [&](const glm::vec3& p) { return glm::vec3(placed.to_space * glm::vec4(p, 1)) + 0.0F; });
  for (const auto& corners : mesh.triangles) {
    TriangleRecord triangle{positions[corners[0]],
                            positions[corners[1]],
                            positions[corners[2]],
                            placed.object,
                            material,
                            static_cast<std::uint32_t>(out.size() - base)};
    if (!has_area(triangle)) triangle.v1 = triangle.v2 = triangle.v0;
    out.push_back(triangle);
  }
}

std::vector<TriangleRecord> triangle_records(std::span<const PlacedMesh> placed, const MaterialTables& materials) {
  std::vector<TriangleRecord> out;
  check_triangle_count(count_triangles(placed));
  out.reserve(count_triangles(placed));
  for (const PlacedMesh& p : placed) append_triangles(p, materials, 0, out);
  return out;
}

ShadingRecords shading_records(std::span<const PlacedMesh> placed, const MaterialTables& materials) {
  ShadingRecords out;
  out.attributes.reserve(count_triangles(placed));
  if (materials.needs_vertices) out.vertices.reserve(count_triangles(placed));
  for (const PlacedMesh& p : placed) append_shading_records(p, materials, out);
  return out;
}

}  // namespace traces
