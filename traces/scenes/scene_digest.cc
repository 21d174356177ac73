#include "traces/scenes/scene_digest.h"

#include <string_view>

#include "sim/sha256.h"

namespace traces {

std::string scene_digest(const Scene& scene) {
  std::string bytes = scene.name;
  const auto add = [&bytes](const auto& values) {
    if (!values.empty()) bytes.append(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(values[0]));
  };
  for (const Mesh& mesh : scene.meshes) {
    add(mesh.positions);
    add(mesh.normals);
    add(mesh.uvs);
    add(mesh.triangles);
    add(std::vector<std::uint32_t>{mesh.material});
  }
  for (const Instance& instance : scene.instances) {
    add(std::vector<std::uint32_t>{instance.mesh, instance.node});
    add(std::vector<glm::mat4>{instance.to_world});
  }
  for (const Node& node : scene.nodes) {
    add(std::vector<std::uint32_t>{node.parent});
    add(std::vector<glm::mat4>{node.matrix});
    add(std::vector<glm::vec3>{node.rest.translation, node.rest.scale});
    add(std::vector<glm::quat>{node.rest.rotation});
  }
  for (const Track& track : scene.tracks) {
    add(std::vector<std::uint32_t>{track.node, static_cast<std::uint32_t>(track.path)});
    add(track.times);
    add(track.values);
  }
  for (const Texture& texture : scene.textures) add(texture.texels);
  for (const Material& m : scene.materials) {
    add(std::vector<glm::vec3>{m.base_colour, m.mirror_tint, m.emission, m.absorption});
    add(std::vector<float>{m.mirror, m.transmission, m.ior, m.metallic, m.roughness, m.dielectric, m.coat,
                           m.normal_scale, m.occlusion_strength, m.opacity, m.alpha_cutoff});
    add(std::vector<std::uint32_t>{m.base_texture.texture, m.emission_texture.texture, m.metal_rough_texture.texture,
                                   m.normal_texture.texture, m.occlusion_texture.texture,
                                   static_cast<std::uint32_t>(m.alpha)});
  }
  for (const Light& l : scene.lights) add(std::vector<glm::vec3>{l.position, l.direction, l.intensity});
  for (const Camera& c : scene.cameras) {
    add(std::vector<glm::mat4>{c.to_world});
    add(std::vector<float>{c.vertical_fov});
  }
  add(std::vector<glm::vec3>{scene.background, scene.ambient});
  return sim::sha256_hex(bytes);
}

}  // namespace traces
