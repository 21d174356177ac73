#include "traces/scenes/modelling/shapes.h"

#include <cmath>
#include <utility>

#include <glm/geometric.hpp>

#include "traces/scenes/modelling/trigonometry.h"

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

Mesh make_box(std::string name, const glm::vec3& lower, const glm::vec3& upper, std::uint32_t cells, float repeats) {
  Mesh mesh;
  const glm::vec3 size = upper - lower;
  for (int axis = 0; axis < 3; ++axis) {
    glm::vec3 u(0), v(0), across(0);
    u[(axis + 1) % 3] = size[(axis + 1) % 3];
    v[(axis + 2) % 3] = size[(axis + 2) % 3];
    across[axis] = size[axis];
    const glm::vec2 spans(repeats * size[(axis + 1) % 3], repeats * size[(axis + 2) % 3]);
    Mesh front = make_quad("", lower + across, u, v, cells);
    scale_uvs(front, spans);
    append(mesh, front);
    Mesh back = make_quad("", lower, v, u, cells);
    scale_uvs(back, {spans.y, spans.x});
    append(mesh, back);
  }
  mesh.name = std::move(name);
  return mesh;
}

Mesh make_rounded_box(std::string name, const glm::vec3& lower, const glm::vec3& upper, float radius,
                      std::uint32_t steps) {
  // A sphere cut into octants: every vertex moves with the nearest corner of the inner box.
  const std::uint32_t cells = 2 * steps + 1;
  Mesh mesh;
  mesh.name = std::move(name);
  const glm::vec3 inner_lower = lower + radius, inner_upper = upper - radius;
  for (int axis = 0; axis < 3; ++axis) {
    for (const float side : {-1.0F, 1.0F}) {
      const auto first = static_cast<std::uint32_t>(mesh.positions.size());
      for (std::uint32_t j = 0; j <= cells; ++j) {
        for (std::uint32_t i = 0; i <= cells; ++i) {
          const auto along = [steps](std::uint32_t k) {
            const float step = static_cast<float>(k <= steps ? k : k - 1) / static_cast<float>(steps);
            return step - 1;  // -1 .. 1, the middle 0 twice
          };
          const auto half = [steps](std::uint32_t k) { return k <= steps ? 0 : 1; };
          glm::vec3 on_cube, corner;
          const int a = (axis + 1) % 3, b = (axis + 2) % 3;
          const std::uint32_t ka = side > 0 ? i : cells - i;
          on_cube[axis] = side;
          on_cube[a] = along(ka);
          on_cube[b] = along(j);
          corner[axis] = side > 0 ? inner_upper[axis] : inner_lower[axis];
          corner[a] = half(ka) != 0 ? inner_upper[a] : inner_lower[a];
          corner[b] = half(j) != 0 ? inner_upper[b] : inner_lower[b];
          const glm::vec3 normal = glm::normalize(on_cube);
          mesh.positions.push_back(corner + radius * normal);
          mesh.normals.push_back(normal);
          const glm::vec3 share = (mesh.positions.back() - lower) / (upper - lower);
          mesh.uvs.emplace_back(share[a], share[b]);
        }
      }
      add_grid(mesh, first, cells, cells);
    }
  }
  return mesh;
}

Mesh make_surface(std::string name, std::uint32_t columns, std::uint32_t rows,
                  const std::function<glm::vec3(float s, float t)>& at, bool closed_s) {
  Mesh mesh;
  mesh.name = std::move(name);
  for (std::uint32_t j = 0; j <= rows; ++j) {
    for (std::uint32_t i = 0; i <= columns; ++i) {
      const float s = static_cast<float>(i) / static_cast<float>(columns);
      const float t = static_cast<float>(j) / static_cast<float>(rows);
      mesh.positions.push_back(at(closed_s && i == columns ? 0.0F : s, t));
      mesh.uvs.emplace_back(s, t);
    }
  }
  add_grid(mesh, 0, columns, rows);
  const auto area = [&mesh](const std::array<std::uint32_t, 3>& t) {
    const glm::vec3 a = mesh.positions[t[0]];
    return glm::cross(mesh.positions[t[1]] - a, mesh.positions[t[2]] - a);
  };
  const auto is_flat = [&](const auto& t) {
    const glm::vec3 a = mesh.positions[t[0]], b = mesh.positions[t[1]], c = mesh.positions[t[2]];
    return a == b || b == c || c == a;
  };
  std::erase_if(mesh.triangles, is_flat);
  mesh.normals.assign(mesh.positions.size(), glm::vec3(0));
  for (const auto& t : mesh.triangles) {
    for (const std::uint32_t corner : t) mesh.normals[corner] += area(t);
  }
  // Coincident vertices share a normal: at the seam, and where a row has shrunk to a point.
  const std::uint32_t across = columns + 1;
  const auto share = [&](std::uint32_t first, std::uint32_t count, std::uint32_t stride) {
    glm::vec3 sum(0);
    for (std::uint32_t k = 0; k < count; ++k) sum += mesh.normals[first + k * stride];
    for (std::uint32_t k = 0; k < count; ++k) mesh.normals[first + k * stride] = sum;
  };
  for (const std::uint32_t row : {0U, rows}) {
    if (mesh.positions[row * across] == mesh.positions[row * across + columns / 2]) share(row * across, across, 1);
  }
  if (closed_s) {
    for (std::uint32_t j = 0; j <= rows; ++j) share(j * across, 2, columns);
  }
  for (glm::vec3& n : mesh.normals) n = glm::dot(n, n) > 0 ? glm::normalize(n) : glm::vec3(0, 1, 0);
  return mesh;
}

void append(Mesh& mesh, const Mesh& other) {
  const auto first = static_cast<std::uint32_t>(mesh.positions.size());
  mesh.positions.insert(mesh.positions.end(), other.positions.begin(), other.positions.end());
  mesh.normals.insert(mesh.normals.end(), other.normals.begin(), other.normals.end());
  if (!mesh.uvs.empty() || !other.uvs.empty()) {  // spheres have none
    mesh.uvs.resize(first);
    mesh.uvs.insert(mesh.uvs.end(), other.uvs.begin(), other.uvs.end());
    mesh.uvs.resize(mesh.positions.size());
  }
  for (const auto& t : other.triangles) mesh.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
}

Mesh transformed(Mesh mesh, const glm::mat4& by) {
  const glm::vec3 x(by[0]), y(by[1]), z(by[2]);
  const bool mirrored = glm::dot(x, glm::cross(y, z)) < 0;
  const glm::mat3 cofactors(glm::cross(y, z), glm::cross(z, x), glm::cross(x, y));
  for (glm::vec3& p : mesh.positions) p = glm::vec3(by * glm::vec4(p, 1));
  for (glm::vec3& n : mesh.normals) n = glm::normalize(mirrored ? -(cofactors * n) : cofactors * n);
  if (mirrored) {
    for (auto& t : mesh.triangles) std::swap(t[1], t[2]);
  }
  return mesh;
}

glm::mat4 placed(const glm::vec3& position, double turns_about_y, const glm::vec3& scale) {
  const float c = cos_turns(turns_about_y), s = sin_turns(turns_about_y);
  return {glm::vec4(c, 0, -s, 0) * scale.x, glm::vec4(0, 1, 0, 0) * scale.y, glm::vec4(s, 0, c, 0) * scale.z,
          glm::vec4(position, 1)};
}

void scale_uvs(Mesh& mesh, const glm::vec2& by) {
  for (glm::vec2& uv : mesh.uvs) uv *= by;
}

std::uint32_t add_mesh(Scene& scene, Mesh mesh, std::uint32_t material) {
  mesh.material = material;
  scene.meshes.push_back(std::move(mesh));
  return static_cast<std::uint32_t>(scene.meshes.size() - 1);
}

std::uint32_t add_instance(Scene& scene, std::uint32_t mesh, const glm::mat4& to_world) {
  scene.instances.push_back({.mesh = mesh, .to_world = to_world});
  return static_cast<std::uint32_t>(scene.instances.size() - 1);
}

void add_object(Scene& scene, Mesh mesh, std::uint32_t material) {
  add_instance(scene, add_mesh(scene, std::move(mesh), material));
}

std::uint32_t add_material(Scene& scene, Material material) {
  scene.materials.push_back(std::move(material));
  return static_cast<std::uint32_t>(scene.materials.size() - 1);
}

Material paint(std::string name, const glm::vec3& colour, float mirror) {
  Material m;
  m.name = std::move(name);
  m.base_colour = colour;
  m.mirror = mirror;
  return m;
}

Material metal(std::string name, const glm::vec3& tint, float mirror) {
  Material m = paint(std::move(name), tint, mirror);
  m.mirror_tint = tint;
  return m;
}

Material glass(std::string name, const glm::vec3& colour, float ior) {
  Material m = paint(std::move(name), colour);
  m.transmission = 1;
  m.ior = ior;
  return m;
}

Material lamp(std::string name, const glm::vec3& emission) {
  Material m = paint(std::move(name), glm::vec3(0));
  m.emission = emission;
  return m;
}

Material textured(std::string name, std::uint32_t texture, const glm::vec3& colour, float mirror) {
  Material m = paint(std::move(name), colour, mirror);
  m.base_texture.texture = texture;
  return m;
}

std::uint64_t triangles_of(const Scene& scene) {
  std::uint64_t sum = 0;
  for (const Instance& instance : scene.instances) sum += scene.meshes[instance.mesh].triangles.size();
  return sum;
}

}  // namespace traces
