#include "traces/scene/gltf/attributes.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "traces/scene/gltf/accessors.h"

namespace traces::gltf {
namespace {

void check_count(const Context& context, const Mesh& mesh, std::size_t count, const char* what) {
  if (count == mesh.positions.size()) return;
  context.refuse(fmt::format("mesh '{}': {} {} for {} vertices", mesh.name, count, what, mesh.positions.size()));
}

std::vector<glm::vec2> placed_uvs(Context& context, const tinygltf::Primitive& primitive,
                                  const TexturePlacement& placement, const Mesh& mesh) {
  const std::string name = fmt::format("TEXCOORD_{}", placement.set);
  const int accessor = attribute(primitive, name);
  if (accessor < 0) {
    context.warn(fmt::format("mesh '{}' has no {}: its textures show one spot everywhere", mesh.name, name));
    return {};
  }
  std::vector<glm::vec2> uvs = read_vec2(context, accessor, "texture coordinates");
  check_count(context, mesh, uvs.size(), "texture coordinates");
  for (glm::vec2& uv : uvs) {
    uv = placement.apply(uv);
    if (!std::isfinite(uv.x) || !std::isfinite(uv.y)) {
      context.refuse(fmt::format("mesh '{}': a texture coordinate is too large", mesh.name));
    }
  }
  return uvs;
}

}  // namespace

int attribute(const tinygltf::Primitive& primitive, const std::string& name) {
  const auto found = primitive.attributes.find(name);
  return found == primitive.attributes.end() ? -1 : found->second;
}

void read_normals(Context& context, const tinygltf::Primitive& primitive, Mesh& mesh) {
  const int accessor = attribute(primitive, "NORMAL");
  if (accessor < 0) return;
  mesh.normals = read_vec3(context, accessor, "normals");
  check_count(context, mesh, mesh.normals.size(), "normals");
}

void read_uvs(Context& context, const tinygltf::Primitive& primitive, const Placements& placements, Mesh& mesh) {
  const std::vector<TexturePlacement>& list = placements.list();
  if (!list.empty()) mesh.uvs = placed_uvs(context, primitive, list[0], mesh);
  if (list.size() > 1) mesh.second_uvs = placed_uvs(context, primitive, list[1], mesh);
}

void read_tangents(Context& context, const tinygltf::Primitive& primitive, Mesh& mesh) {
  const int accessor = attribute(primitive, "TANGENT");
  if (accessor < 0) return;
  mesh.tangents = read_vec4(context, accessor, "tangents");
  check_count(context, mesh, mesh.tangents.size(), "tangents");
  for (glm::vec4& tangent : mesh.tangents) {
    const glm::dvec3 along(tangent);
    const double length = glm::length(along);
    tangent = glm::vec4(length > 0 ? glm::vec3(along / length) : glm::vec3(1, 0, 0), tangent.w < 0 ? -1.0F : 1.0F);
  }
}

void read_colours(Context& context, const tinygltf::Primitive& primitive, Mesh& mesh) {
  const int index = attribute(primitive, "COLOR_0");
  if (index < 0) return;
  if (context.at(context.model.accessors, index, "accessors").type == TINYGLTF_TYPE_VEC3) {
    context.budget.take(mesh.positions.size(), sizeof(glm::vec4), "vertex colours");
    for (const glm::vec3& colour : read_vec3(context, index, "colours")) mesh.colours.emplace_back(colour, 1);
  } else {
    mesh.colours = read_vec4(context, index, "colours");
  }
  check_count(context, mesh, mesh.colours.size(), "colours");
  for (glm::vec4& colour : mesh.colours) colour = glm::clamp(colour, 0.0F, 1.0F);
  if (std::ranges::all_of(mesh.colours, [](const glm::vec4& c) { return c == glm::vec4(1); })) mesh.colours.clear();
}

}  // namespace traces::gltf
