#include "traces/scenes/modelling/forms.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>

#include "traces/scenes/modelling/patterns.h"
#include "traces/scenes/modelling/shapes.h"
#include "traces/scenes/modelling/trigonometry.h"

namespace traces {
namespace {

glm::mat4 axes_of(const glm::vec3& x, const glm::vec3& y, const glm::vec3& z, const glm::vec3& origin) {
  return {glm::vec4(x, 0), glm::vec4(y, 0), glm::vec4(z, 0), glm::vec4(origin, 1)};
}

void add_flat(Mesh& mesh, const std::array<glm::vec3, 4>& corners) {
  const auto first = static_cast<std::uint32_t>(mesh.positions.size());
  const glm::vec3 normal = glm::normalize(glm::cross(corners[1] - corners[0], corners[2] - corners[0]));
  for (const glm::vec3& p : corners) {
    mesh.positions.push_back(p);
    mesh.normals.push_back(normal);
    mesh.uvs.emplace_back(p.x, p.y);
  }
  mesh.triangles.push_back({first, first + 1, first + 2});
  mesh.triangles.push_back({first, first + 2, first + 3});
}

}  // namespace

glm::mat4 wall_axes(const glm::vec3& origin, const glm::vec3& outward) {
  const glm::vec3 up(0, 1, 0);
  return axes_of(glm::cross(up, outward), up, outward, origin);
}

glm::mat4 floor_axes(const glm::vec3& origin) { return axes_of({1, 0, 0}, {0, 0, -1}, {0, 1, 0}, origin); }

glm::mat4 ceiling_axes(const glm::vec3& origin) { return axes_of({1, 0, 0}, {0, 0, 1}, {0, -1, 0}, origin); }

glm::mat4 rotation_about(const glm::vec3& origin, const glm::vec3& axis, double turns) {
  glm::mat4 m = glm::mat4_cast(axis_rotation(axis, turns));
  m[3] = glm::vec4(origin, 1);
  return m;
}

Mesh make_panel(std::string name, float width, float height, std::span<const glm::vec2> rings, std::uint32_t cells) {
  Mesh mesh;
  mesh.name = std::move(name);
  const auto corners = [&](const glm::vec2& ring) {
    const float i = ring.x, z = ring.y;
    return std::array<glm::vec3, 4>{glm::vec3(i, i, z), glm::vec3(width - i, i, z), glm::vec3(width - i, height - i, z),
                                    glm::vec3(i, height - i, z)};
  };
  for (std::size_t k = 0; k + 1 < rings.size(); ++k) {
    const auto outer = corners(rings[k]), inner = corners(rings[k + 1]);
    for (std::size_t side = 0; side < 4; ++side) {
      const std::size_t next = (side + 1) % 4;
      add_flat(mesh, {outer[side], outer[next], inner[next], inner[side]});
    }
  }
  const auto last = corners(rings.back());
  append_mesh(mesh, make_quad("", last[0], last[1] - last[0], last[3] - last[0], cells));
  return mesh;
}

Mesh make_cushion(std::string name, const glm::vec3& lower, const glm::vec3& upper, float radius, std::uint32_t steps,
                  std::uint32_t cells) {
  const std::uint32_t side_cells = 2 * steps + cells;
  const glm::vec3 inner_lower = lower + radius, inner_upper = upper - radius;
  const auto on_edge = [&](std::uint32_t k) {
    const float step = static_cast<float>(steps);
    if (k < steps) return static_cast<float>(k) / step - 1;
    return k <= steps + cells ? 0.0F : static_cast<float>(k - steps - cells) / step;
  };
  const auto between = [&](std::uint32_t k, float low, float high) {
    const float share = (static_cast<float>(k) - static_cast<float>(steps)) / static_cast<float>(cells);
    return low + std::clamp(share, 0.0F, 1.0F) * (high - low);
  };
  Mesh mesh;
  mesh.name = std::move(name);
  for (int axis = 0; axis < 3; ++axis) {
    const int a = (axis + 1) % 3, b = (axis + 2) % 3;
    for (const float side : {-1.0F, 1.0F}) {
      const auto first = static_cast<std::uint32_t>(mesh.positions.size());
      for (std::uint32_t j = 0; j <= side_cells; ++j) {
        for (std::uint32_t i = 0; i <= side_cells; ++i) {
          const std::uint32_t ka = side > 0 ? i : side_cells - i;
          glm::vec3 on_cube, inner;
          on_cube[axis] = side;
          on_cube[a] = on_edge(ka);
          on_cube[b] = on_edge(j);
          inner[axis] = side > 0 ? inner_upper[axis] : inner_lower[axis];
          inner[a] = between(ka, inner_lower[a], inner_upper[a]);
          inner[b] = between(j, inner_lower[b], inner_upper[b]);
          const glm::vec3 normal = glm::normalize(on_cube);
          const glm::vec3 p = inner + radius * normal;
          mesh.positions.push_back(p);
          mesh.normals.push_back(normal);
          mesh.uvs.emplace_back(p[a], p[b]);
        }
      }
      add_grid(mesh, first, side_cells, side_cells);
    }
  }
  return mesh;
}

Mesh warp_mesh(Mesh mesh, const std::function<glm::vec3(const glm::vec3&)>& to) {
  constexpr float kStep = 1e-3F;
  for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
    const glm::vec3 p = mesh.positions[i], n = mesh.normals[i];
    const glm::vec3 other = std::abs(n.y) < 0.7F ? glm::vec3(0, 1, 0) : glm::vec3(1, 0, 0);
    const glm::vec3 u = glm::normalize(glm::cross(other, n)), v = glm::cross(n, u);
    const glm::vec3 normal = glm::cross(to(p + kStep * u) - to(p - kStep * u), to(p + kStep * v) - to(p - kStep * v));
    mesh.positions[i] = to(p);
    if (glm::dot(normal, normal) > 0) mesh.normals[i] = glm::normalize(normal);
  }
  return mesh;
}

void project_uvs(Mesh& mesh, float repeats, bool upright) {
  mesh.uvs.resize(mesh.positions.size());
  for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
    const glm::vec3 p = mesh.positions[i], n = glm::abs(mesh.normals[i]);
    glm::vec2 uv(p.x, p.z);
    if (n.x > n.y && n.x >= n.z) {
      uv = upright ? glm::vec2(p.y, p.z) : glm::vec2(p.z, -p.y);
    } else if (n.z > n.y) {
      uv = upright ? glm::vec2(p.y, p.x) : glm::vec2(p.x, -p.y);
    }
    mesh.uvs[i] = repeats * uv;
  }
}

Mesh make_curtain(std::string name, float width, float height, std::uint32_t folds, float depth, std::uint32_t columns,
                  std::uint32_t rows, std::uint32_t seed) {
  return make_surface(std::move(name), columns, rows, [=](float s, float t) {
    const float sway = 0.15F * (value_noise(s * 0.999F, t * 0.999F, 5, seed) - 0.5F);
    const float wave = sin_turns(static_cast<double>(s * static_cast<float>(folds) + sway));
    const float second = sin_turns(static_cast<double>(s * 2.7F * static_cast<float>(folds) + 0.3F));
    const float loose = 1 - 0.45F * t;
    return glm::vec3(s * width + 0.06F * (1 - t) * (value_noise(s * 0.999F, 0, 7, seed + 1) - 0.5F), height * t,
                     depth * loose * (wave + 0.25F * second));
  });
}

glm::vec2 rounded_rectangle_point(double turns, float a, float b) {
  const glm::vec2 c = circle_point(turns);
  const glm::vec2 c2 = c * c, c4 = c2 * c2, c8 = c4 * c4;
  const float eighth_root = std::sqrt(std::sqrt(std::sqrt(c8.x + c8.y)));
  return glm::vec2(a * c.x, b * c.y) / eighth_root;
}

void add_leaf(Mesh& mesh, const glm::vec3& base, const glm::vec3& direction, float length, float width, float droop,
              std::uint32_t rows) {
  const glm::vec3 level(direction.x, 0, direction.z);
  const glm::vec3 out = glm::dot(level, level) > 1e-6F ? glm::normalize(level) : glm::vec3(1, 0, 0);
  const glm::vec3 across = glm::cross(glm::vec3(0, 1, 0), out);
  append_mesh(mesh, make_surface("", 2, rows, [&](float s, float t) {
                const float half = width * std::sqrt(t * (1 - t)) * (1.3F - 0.6F * t);
                const glm::vec3 rib =
                    base + length * (t * direction - glm::vec3(0, droop * t * t, 0) + 0.3F * droop * t * t * out);
                const float side = 1 - 2 * s;
                return rib + half * (side * across + glm::vec3(0, 0.35F * std::abs(side), 0));
              }));
}

}  // namespace traces
