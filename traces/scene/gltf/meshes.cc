#include "traces/scene/gltf/meshes.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include <fmt/format.h>
#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "sim/io/printable.h"
#include "traces/scene/gltf/accessors.h"
#include "traces/scene/gltf/motion.h"
#include "traces/scene/normals_tangents.h"

namespace traces::gltf {
namespace {

void check_value_count(const Context& context, const Mesh& mesh, std::size_t count, const char* what) {
  if (count == mesh.positions.size()) return;
  context.refuse(fmt::format("mesh '{}': {} {} for {} vertices", mesh.name, count, what, mesh.positions.size()));
}

std::vector<glm::vec2> placed_uvs(Context& context, const tinygltf::Primitive& primitive,
                                  const TexturePlacement& placement, const Mesh& mesh) {
  const std::string name = fmt::format("TEXCOORD_{}", placement.set);
  const int accessor = find_attribute(primitive, name);
  if (accessor < 0) {
    context.add_warning(fmt::format("mesh '{}' has no {}: its textures show one spot everywhere", mesh.name, name));
    return {};
  }
  std::vector<glm::vec2> uvs = read_vec2(context, accessor, "texture coordinates");
  check_value_count(context, mesh, uvs.size(), "texture coordinates");
  for (glm::vec2& uv : uvs) {
    uv = placement.transform_uv(uv);
    if (!std::isfinite(uv.x) || !std::isfinite(uv.y)) {
      context.refuse(fmt::format("mesh '{}': a texture coordinate is too large", mesh.name));
    }
  }
  return uvs;
}

}  // namespace

int find_attribute(const tinygltf::Primitive& primitive, const std::string& name) {
  const auto found = primitive.attributes.find(name);
  return found == primitive.attributes.end() ? -1 : found->second;
}

void read_normals(Context& context, const tinygltf::Primitive& primitive, Mesh& mesh) {
  const int accessor = find_attribute(primitive, "NORMAL");
  if (accessor < 0) return;
  mesh.normals = read_vec3(context, accessor, "normals");
  check_value_count(context, mesh, mesh.normals.size(), "normals");
}

void read_uvs(Context& context, const tinygltf::Primitive& primitive, const Placements& placements, Mesh& mesh) {
  const std::vector<TexturePlacement>& list = placements.all_placements();
  if (!list.empty()) mesh.uvs = placed_uvs(context, primitive, list[0], mesh);
  if (list.size() > 1) mesh.second_uvs = placed_uvs(context, primitive, list[1], mesh);
}

void read_tangents(Context& context, const tinygltf::Primitive& primitive, Mesh& mesh) {
  const int accessor = find_attribute(primitive, "TANGENT");
  if (accessor < 0) return;
  mesh.tangents = read_vec4(context, accessor, "tangents");
  check_value_count(context, mesh, mesh.tangents.size(), "tangents");
  for (glm::vec4& tangent : mesh.tangents) {
    const glm::dvec3 along(tangent);
    const double length = glm::length(along);
    tangent = glm::vec4(length > 0 ? glm::vec3(along / length) : glm::vec3(1, 0, 0), tangent.w < 0 ? -1.0F : 1.0F);
  }
}

void read_colours(Context& context, const tinygltf::Primitive& primitive, Mesh& mesh) {
  const int index = find_attribute(primitive, "COLOR_0");
  if (index < 0) return;
  if (context.at(context.model.accessors, index, "accessors").type == TINYGLTF_TYPE_VEC3) {
    context.budget.take_memory(mesh.positions.size(), sizeof(glm::vec4), "vertex colours");
    for (const glm::vec3& colour : read_vec3(context, index, "colours")) mesh.colours.emplace_back(colour, 1);
  } else {
    mesh.colours = read_vec4(context, index, "colours");
  }
  check_value_count(context, mesh, mesh.colours.size(), "colours");
  for (glm::vec4& colour : mesh.colours) colour = glm::clamp(colour, 0.0F, 1.0F);
  if (std::ranges::all_of(mesh.colours, [](const glm::vec4& c) { return c == glm::vec4(1); })) mesh.colours.clear();
}

namespace {

bool is_triangles(int mode) {
  return mode == TINYGLTF_MODE_TRIANGLES || mode == TINYGLTF_MODE_TRIANGLE_STRIP || mode == TINYGLTF_MODE_TRIANGLE_FAN;
}

/// Builds triangles from lists, strips or fans; in strips and fans, triangles with two equal corners are left out.
std::vector<std::array<std::uint32_t, 3>> assemble_triangles(const std::vector<std::uint32_t>& order, int mode) {
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

/// Returns the indices of a glTF primitive's vertices, in the order in which they form triangles.
std::vector<std::uint32_t> read_vertex_order(Context& context, const tinygltf::Primitive& primitive, const Mesh& mesh) {
  std::vector<std::uint32_t> order;
  if (primitive.indices < 0) {
    order.resize(mesh.positions.size());
    std::iota(order.begin(), order.end(), 0U);
    return order;
  }
  order = read_indices(context, primitive.indices);
  for (const std::uint32_t index : order) {
    if (index >= mesh.positions.size()) {
      context.refuse(fmt::format("mesh '{}': index {} of {} vertices", mesh.name, index, mesh.positions.size()));
    }
  }
  return order;
}

}  // namespace

std::uint32_t Meshes::material_of(const tinygltf::Primitive& primitive) {
  if (primitive.material >= 0) {
    context_.at(context_.model.materials, primitive.material, "materials");
    return static_cast<std::uint32_t>(primitive.material);
  }
  if (default_material_ == kNone) {
    default_material_ = static_cast<std::uint32_t>(context_.scene.materials.size());
    Material material;
    material.name = "default";
    material.base_colour = glm::vec3(1);
    material.double_sided = false;
    context_.scene.materials.push_back(material);
  }
  return default_material_;
}

void Meshes::multiply_emission_by_vertex_colours(Mesh& mesh) {
  if (mesh.colours.empty() || context_.scene.materials[mesh.material].casts_light) return;
  glm::dvec4 sum(0);
  for (const glm::vec4& colour : mesh.colours) sum += glm::dvec4(colour);
  Material material = context_.scene.materials[mesh.material];
  material.emission *= glm::vec3(sum / static_cast<double>(mesh.colours.size()));
  mesh.material = static_cast<std::uint32_t>(context_.scene.materials.size());
  context_.scene.materials.push_back(std::move(material));
}

Mesh Meshes::read_mesh(const tinygltf::Primitive& primitive, const std::string& name, int skin) {
  constexpr std::uint64_t kCornerBytes = 96;    // one corner of a triangle with all vertex attributes
  constexpr std::uint64_t kTangentBytes = 160;  // temporaries of a corner, and a copy of its vertex if it is split
  static const Placements kNowhere;
  Mesh mesh;
  mesh.name = name;
  mesh.material = material_of(primitive);
  mesh.positions = read_vec3(context_, find_attribute(primitive, "POSITION"), "positions");
  const bool is_default = mesh.material >= placements_.size();
  const bool bumpy = context_.scene.materials[mesh.material].normal_texture.is_used();
  read_normals(context_, primitive, mesh);
  read_uvs(context_, primitive, is_default ? kNowhere : placements_[mesh.material], mesh);
  read_colours(context_, primitive, mesh);
  if (bumpy && !mesh.normals.empty()) read_tangents(context_, primitive, mesh);
  const std::vector<std::uint32_t> order = read_vertex_order(context_, primitive, mesh);
  context_.budget.take_memory(order.size(), kCornerBytes, "the triangles of mesh '" + name + "'");
  mesh.triangles = assemble_triangles(order, primitive.mode);
  const bool flat = mesh.normals.empty();
  std::vector<std::uint32_t> from;  // for each vertex of the mesh, the vertex of the file that it copies
  if (!flat) {
    repair_normals(mesh);
    from.resize(mesh.positions.size());
    std::iota(from.begin(), from.end(), 0U);
  } else {
    from = make_flat_normals(mesh);
  }
  if (bumpy && mesh.tangents.empty()) {
    context_.budget.take_memory(order.size(), kTangentBytes, "tangents");
    const bool second = context_.scene.materials[mesh.material].normal_texture.second_uv;
    std::vector<std::uint32_t> of_file;
    for (const std::uint32_t vertex : compute_tangents(mesh, second)) of_file.push_back(from[vertex]);
    from = std::move(of_file);
  }
  multiply_emission_by_vertex_colours(mesh);
  if (is_deforming(primitive, skin)) mesh.deformation = read_deformation(context_, primitive, skin, mesh, flat, from);
  return mesh;
}

std::vector<std::uint32_t> Meshes::primitives_of(int index, int skin) {
  const tinygltf::Mesh& mesh = context_.at(context_.model.meshes, index, "meshes");
  std::vector<std::uint32_t> shown;
  const std::string name = mesh.name.empty() ? fmt::format("mesh {}", index) : sim::printable(mesh.name);
  for (std::size_t i = 0; i < mesh.primitives.size(); ++i) {
    const tinygltf::Primitive& primitive = mesh.primitives[i];
    const bool rigid = !is_deforming(primitive, skin);
    const auto known = read_.find({index, i});
    if (rigid && known != read_.end()) {
      if (known->second != kNone) shown.push_back(known->second);
      continue;
    }
    const std::string part = mesh.primitives.size() == 1 ? name : fmt::format("{}/{}", name, i);
    const std::uint32_t added = add_mesh(primitive, part, skin);
    if (rigid) read_.emplace(std::pair{index, i}, added);
    if (added != kNone) shown.push_back(added);
  }
  return shown;
}

std::uint32_t Meshes::add_mesh(const tinygltf::Primitive& primitive, const std::string& name, int skin) {
  if (!is_triangles(primitive.mode)) {
    context_.add_warning(fmt::format("mesh '{}': points and lines are left out", name));
    return kNone;
  }
  if (find_attribute(primitive, "POSITION") < 0) {
    context_.add_warning(fmt::format("mesh '{}' has no positions and is left out", name));
    return kNone;
  }
  Mesh mesh = read_mesh(primitive, name, skin);
  if (mesh.triangles.empty()) return kNone;
  float reach = 0;
  for (const glm::vec3& p : mesh.positions) reach = std::max({reach, std::abs(p.x), std::abs(p.y), std::abs(p.z)});
  largest_coordinates_.push_back(reach);
  context_.scene.meshes.push_back(std::move(mesh));
  return static_cast<std::uint32_t>(context_.scene.meshes.size() - 1);
}

}  // namespace traces::gltf
