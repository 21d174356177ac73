#include "traces/scene/gltf/meshes.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include <fmt/format.h>

#include "sim/io/printable.h"
#include "traces/scene/gltf/accessors.h"
#include "traces/scene/gltf/skins.h"
#include "traces/scene/normals.h"

namespace traces::gltf {
namespace {

bool is_triangles(int mode) {
  return mode == TINYGLTF_MODE_TRIANGLES || mode == TINYGLTF_MODE_TRIANGLE_STRIP || mode == TINYGLTF_MODE_TRIANGLE_FAN;
}

int attribute(const tinygltf::Primitive& primitive, const std::string& name) {
  const auto found = primitive.attributes.find(name);
  return found == primitive.attributes.end() ? -1 : found->second;
}

/// Lists are taken as they are; strips and fans lose the triangles that only stitch (two equal corners).
std::vector<std::array<std::uint32_t, 3>> assemble(const std::vector<std::uint32_t>& order, int mode) {
  std::vector<std::array<std::uint32_t, 3>> triangles;
  const std::size_t step = mode == TINYGLTF_MODE_TRIANGLES ? 3 : 1;
  triangles.reserve(order.size() / step);
  for (std::size_t i = 0; i + 2 < order.size(); i += step) {
    const std::size_t odd = mode == TINYGLTF_MODE_TRIANGLE_STRIP ? i % 2 : 0;
    const std::size_t first = mode == TINYGLTF_MODE_TRIANGLE_FAN ? 0 : i;
    const std::array<std::uint32_t, 3> t{order[first], order[i + 1 + odd], order[i + 2 - odd]};
    if (step == 1 && (t[0] == t[1] || t[1] == t[2] || t[2] == t[0])) continue;
    triangles.push_back(t);
  }
  return triangles;
}

}  // namespace

std::uint32_t Meshes::material_of(const tinygltf::Primitive& primitive) {
  if (primitive.material >= 0) {
    context_.at(context_.model.materials, primitive.material, "materials");
    return static_cast<std::uint32_t>(primitive.material);
  }
  const std::size_t none = context_.model.materials.size();  // glTF's default material stands behind those of the file
  if (context_.scene.materials.size() == none) {
    Material material;
    material.name = "default";
    material.base_colour = glm::vec3(1);
    context_.scene.materials.push_back(material);
  }
  return static_cast<std::uint32_t>(none);
}

void Meshes::read_uvs(const tinygltf::Primitive& primitive, Mesh& mesh) {
  TexturePlacement placement;
  if (mesh.material < placements_.size()) placement = placements_[mesh.material];
  const int accessor = attribute(primitive, fmt::format("TEXCOORD_{}", placement.set));
  if (accessor < 0) return;
  mesh.uvs = read_vec2(context_, accessor, "texture coordinates");
  if (mesh.uvs.size() != mesh.positions.size()) {
    context_.refuse(fmt::format("mesh '{}': {} texture coordinates for {} vertices", mesh.name, mesh.uvs.size(),
                                mesh.positions.size()));
  }
  for (glm::vec2& uv : mesh.uvs) {
    uv = placement.apply(uv);
    if (!std::isfinite(uv.x) || !std::isfinite(uv.y)) {
      context_.refuse(fmt::format("mesh '{}': a texture coordinate is too large", mesh.name));
    }
  }
}

Mesh Meshes::read(const tinygltf::Primitive& primitive, const std::string& name, int skin) {
  Mesh mesh;
  mesh.name = name;
  mesh.material = material_of(primitive);
  mesh.positions = read_vec3(context_, attribute(primitive, "POSITION"), "positions");
  if (const int normals = attribute(primitive, "NORMAL"); normals >= 0) {
    mesh.normals = read_vec3(context_, normals, "normals");
    if (mesh.normals.size() != mesh.positions.size()) {
      context_.refuse(
          fmt::format("mesh '{}': {} normals for {} vertices", name, mesh.normals.size(), mesh.positions.size()));
    }
  }
  read_uvs(primitive, mesh);
  std::vector<std::uint32_t> order;
  if (primitive.indices >= 0) {
    order = read_indices(context_, primitive.indices);
    for (const std::uint32_t index : order) {
      if (index >= mesh.positions.size()) {
        context_.refuse(fmt::format("mesh '{}': index {} of {} vertices", name, index, mesh.positions.size()));
      }
    }
  } else {
    order.resize(mesh.positions.size());
    std::iota(order.begin(), order.end(), 0U);
  }
  context_.budget.take(order.size(), sizeof(glm::vec3) * 4, "the triangles of mesh '" + name + "'");
  mesh.triangles = assemble(order, primitive.mode);
  const bool flat = mesh.normals.empty();
  std::vector<std::uint32_t> from;  // the vertices of the file that those of the mesh are made from
  if (!flat) {
    repair_normals(mesh);
    from.resize(mesh.positions.size());
    std::iota(from.begin(), from.end(), 0U);
  } else {
    for (const auto& triangle : mesh.triangles) from.insert(from.end(), triangle.begin(), triangle.end());
    flatten_normals(mesh);
  }
  if (deforms(primitive, skin)) mesh.deformation = read_deformation(context_, primitive, skin, mesh, flat, from);
  return mesh;
}

std::vector<std::uint32_t> Meshes::primitives_of(int index, int skin) {
  const tinygltf::Mesh& mesh = context_.at(context_.model.meshes, index, "meshes");
  std::vector<std::uint32_t> shown;
  const std::string name = mesh.name.empty() ? fmt::format("mesh {}", index) : sim::printable(mesh.name);
  for (std::size_t i = 0; i < mesh.primitives.size(); ++i) {
    const tinygltf::Primitive& primitive = mesh.primitives[i];
    const bool rigid = !deforms(primitive, skin);
    const auto known = read_.find({index, i});
    if (rigid && known != read_.end()) {
      if (known->second != kNone) shown.push_back(known->second);
      continue;
    }
    const std::string part = mesh.primitives.size() == 1 ? name : fmt::format("{}/{}", name, i);
    const std::uint32_t added = add(primitive, part, skin);
    if (rigid) read_.emplace(std::pair{index, i}, added);
    if (added != kNone) shown.push_back(added);
  }
  return shown;
}

std::uint32_t Meshes::add(const tinygltf::Primitive& primitive, const std::string& name, int skin) {
  if (!is_triangles(primitive.mode)) {
    context_.warn(fmt::format("mesh '{}': points and lines are left out", name));
    return kNone;
  }
  if (attribute(primitive, "POSITION") < 0) {
    context_.warn(fmt::format("mesh '{}' has no positions and is left out", name));
    return kNone;
  }
  if (attribute(primitive, "COLOR_0") >= 0) context_.warn(fmt::format("mesh '{}': vertex colours are not shown", name));
  Mesh mesh = read(primitive, name, skin);
  if (mesh.triangles.empty()) return kNone;
  float reach = 0;
  for (const glm::vec3& p : mesh.positions) reach = std::max({reach, std::abs(p.x), std::abs(p.y), std::abs(p.z)});
  reaches_.push_back(reach);
  context_.scene.meshes.push_back(std::move(mesh));
  return static_cast<std::uint32_t>(context_.scene.meshes.size() - 1);
}

}  // namespace traces::gltf
