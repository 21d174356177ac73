#include "traces/scene/builtin/shapes.h"

#include <cmath>
#include <string_view>
#include <utility>

#include <glm/geometric.hpp>

#include "sim/sha256.h"

namespace traces {

void add_grid(Mesh& mesh, std::uint32_t first, std::uint32_t columns, std::uint32_t rows) {
  for (std::uint32_t j = 0; j < rows; ++j) {
    for (std::uint32_t i = 0; i < columns; ++i) {
      const std::uint32_t a = first + j * (columns + 1) + i;
      const std::uint32_t c = a + columns + 1;
      mesh.triangles.push_back({a, a + 1, c + 1});
      mesh.triangles.push_back({a, c + 1, c});
    }
  }
}

Mesh make_quad(std::string name, const glm::vec3& corner, const glm::vec3& u, const glm::vec3& v, std::uint32_t cells,
               float repeats) {
  Mesh mesh;
  mesh.name = std::move(name);
  const glm::vec3 normal = glm::normalize(glm::cross(u, v));
  for (std::uint32_t j = 0; j <= cells; ++j) {
    for (std::uint32_t i = 0; i <= cells; ++i) {
      const float s = static_cast<float>(i) / static_cast<float>(cells);
      const float t = static_cast<float>(j) / static_cast<float>(cells);
      mesh.positions.push_back(corner + s * u + t * v);
      mesh.normals.push_back(normal);
      mesh.uvs.emplace_back(s * repeats, t * repeats);
    }
  }
  add_grid(mesh, 0, cells, cells);
  return mesh;
}

Mesh make_sphere(std::string name, const glm::vec3& centre, float radius, std::uint32_t cells) {
  Mesh mesh;
  mesh.name = std::move(name);
  for (int axis = 0; axis < 3; ++axis) {
    for (const float side : {-1.0F, 1.0F}) {
      const Mesh face = make_quad("", glm::vec3(-1), glm::vec3(2, 0, 0), glm::vec3(0, 2, 0), cells);
      const auto first = static_cast<std::uint32_t>(mesh.positions.size());
      for (const glm::vec3& p : face.positions) {
        glm::vec3 on_cube;
        on_cube[axis] = side;
        on_cube[(axis + 1) % 3] = side * p.x;
        on_cube[(axis + 2) % 3] = p.y;
        const glm::vec3 normal = glm::normalize(on_cube);
        mesh.positions.push_back(centre + radius * normal);
        mesh.normals.push_back(normal);
      }
      add_grid(mesh, first, cells, cells);
    }
  }
  return mesh;
}

void add_object(Scene& scene, Mesh mesh, std::uint32_t material) {
  mesh.material = material;
  scene.instances.push_back({static_cast<std::uint32_t>(scene.meshes.size()), glm::mat4(1)});
  scene.meshes.push_back(std::move(mesh));
}

std::uint32_t add_material(Scene& scene, Material material) {
  scene.materials.push_back(std::move(material));
  return static_cast<std::uint32_t>(scene.materials.size() - 1);
}

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
  }
  for (const Texture& texture : scene.textures) add(texture.texels);
  for (const Material& m : scene.materials) {
    add(std::vector<float>{m.base_colour.x, m.base_colour.y, m.base_colour.z, m.mirror, m.transmission, m.ior,
                           m.mirror_tint.x, m.mirror_tint.y, m.mirror_tint.z, m.emission.x, m.emission.y,
                           m.emission.z});
  }
  for (const Light& l : scene.lights) {
    add(std::vector<float>{l.position.x, l.position.y, l.position.z, l.direction.x, l.direction.y, l.direction.z,
                           l.intensity.x, l.intensity.y, l.intensity.z});
  }
  return sim::sha256_hex(bytes);
}

}  // namespace traces
