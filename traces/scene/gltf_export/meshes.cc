#include "traces/scene/gltf_export/meshes.h"

#include <algorithm>
#include <array>

#include <glm/common.hpp>

namespace traces::gltf_export {
namespace {

/// Merges repeated joints and sets unused ones to joint 0, as glTF demands.
void tidy(std::array<std::uint16_t, 4>& joints, glm::vec4& weights) {
  for (int i = 0; i < 4; ++i) {
    for (int earlier = 0; earlier < i; ++earlier) {
      const bool same = joints[static_cast<std::size_t>(i)] == joints[static_cast<std::size_t>(earlier)];
      if (!same || !(weights[earlier] > 0)) continue;
      weights[earlier] += weights[i];
      weights[i] = 0;
    }
    if (!(weights[i] > 0)) joints[static_cast<std::size_t>(i)] = 0;
  }
}

/// Returns the number of texture coordinate sets that the material's textures use.
int uv_sets(const Material& m) {
  int sets = 0;
  for (const TextureUse& use :
       {m.base_texture, m.emission_texture, m.metal_rough_texture, m.normal_texture, m.occlusion_texture}) {
    if (use.used()) sets = std::max(sets, use.second_uv ? 2 : 1);
  }
  return sets;
}

void write_deformation(const Deformation& d, tinygltf::Primitive& to, Document& out) {
  if (!d.joints.empty()) {
    std::vector<std::array<std::uint16_t, 4>> joints = d.joints;
    std::vector<glm::vec4> weights = d.weights;
    for (std::size_t i = 0; i < joints.size(); ++i) tidy(joints[i], weights[i]);
    to.attributes["JOINTS_0"] = out.add(joints);
    to.attributes["WEIGHTS_0"] = out.add(weights);
  }
  for (std::size_t i = 0; i < d.target_positions.size(); ++i) {
    std::map<std::string, int>& target = to.targets.emplace_back();
    target["POSITION"] = out.add(d.target_positions[i], true);
    if (!d.normals.empty() && i < d.target_normals.size() && !d.target_normals[i].empty())
      target["NORMAL"] = out.add(d.target_normals[i]);
  }
}

}  // namespace

tinygltf::Primitive Meshes::write(const Mesh& mesh) {
  const Deformation* d = mesh.deformation.get();
  tinygltf::Primitive to;
  to.mode = TINYGLTF_MODE_TRIANGLES;
  if (mesh.material < scene_.materials.size()) to.material = static_cast<int>(mesh.material);
  const std::vector<glm::vec3>& normals = d != nullptr ? d->normals : mesh.normals;
  const std::vector<glm::vec4>& tangents = d != nullptr ? d->tangents : mesh.tangents;
  to.attributes["POSITION"] = out_.add(d != nullptr ? d->positions : mesh.positions, true);
  if (!normals.empty()) to.attributes["NORMAL"] = out_.add(normals);
  if (!normals.empty() && !tangents.empty()) to.attributes["TANGENT"] = out_.add(tangents);
  const int sets = to.material < 0 ? 0 : uv_sets(scene_.materials[mesh.material]);
  const std::vector<glm::vec2> none(mesh.positions.size());  // textures without coordinates are looked up at 0, 0
  if (!mesh.uvs.empty() || sets > 0) to.attributes["TEXCOORD_0"] = out_.add(mesh.uvs.empty() ? none : mesh.uvs);
  if (sets > 1) to.attributes["TEXCOORD_1"] = out_.add(mesh.second_uvs.empty() ? none : mesh.second_uvs);
  if (!mesh.colours.empty()) {
    std::vector<glm::vec4> colours = mesh.colours;
    for (glm::vec4& colour : colours) colour = glm::clamp(colour, 0.0F, 1.0F);
    to.attributes["COLOR_0"] = out_.add(colours);
  }
  if (d != nullptr) write_deformation(*d, to, out_);
  to.indices = out_.add(mesh.triangles, mesh.positions.size() > 0xffff);  // 0xffff itself is not a valid 16-bit index
  return to;
}

const tinygltf::Primitive& Meshes::primitive_of(std::uint32_t mesh) {
  const auto found = primitives_.find(mesh);
  if (found != primitives_.end()) return found->second;
  return primitives_.emplace(mesh, write(scene_.meshes[mesh])).first->second;
}

int Meshes::mesh_of(const std::vector<std::uint32_t>& parts) {
  const auto [entry, is_new] = meshes_.try_emplace(parts, static_cast<int>(out_.model.meshes.size()));
  if (!is_new) return entry->second;
  tinygltf::Mesh to;
  to.name = scene_.meshes[parts.front()].name;
  for (const std::uint32_t part : parts) to.primitives.push_back(primitive_of(part));
  out_.model.meshes.push_back(to);
  return entry->second;
}

}  // namespace traces::gltf_export
