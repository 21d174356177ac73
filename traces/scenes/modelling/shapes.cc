#include "traces/scenes/modelling/shapes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include <glm/geometric.hpp>

#include "traces/scenes/modelling/trigonometry.h"

namespace traces {
namespace {

/// Removes triangles with two corners at the same position.
void remove_collapsed_triangles(Mesh& mesh) {
  std::erase_if(mesh.triangles, [&](const auto& t) {
    const glm::vec3 a = mesh.positions[t[0]], b = mesh.positions[t[1]], c = mesh.positions[t[2]];
    return a == b || b == c || c == a;
  });
}

}  // namespace

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
    append_mesh(mesh, front);
    Mesh back = make_quad("", lower, v, u, cells);
    scale_uvs(back, {spans.y, spans.x});
    append_mesh(mesh, back);
  }
  mesh.name = std::move(name);
  return mesh;
}

Mesh make_rounded_box(std::string name, const glm::vec3& lower, const glm::vec3& upper, float radius,
                      std::uint32_t steps) {
  // The box is a sphere cut into octants: every vertex moves with the nearest corner of the inner box.
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
            return step - 1;  // -1 to 1, with the middle 0 twice
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
  remove_collapsed_triangles(mesh);
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

void append_mesh(Mesh& mesh, const Mesh& other) {
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

Mesh transform_mesh(Mesh mesh, const glm::mat4& by) {
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

glm::mat4 placement_at(const glm::vec3& position, double turns_about_y, const glm::vec3& scale) {
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

std::uint32_t add_texture(Scene& scene, Texture texture) {
  scene.textures.push_back(std::move(texture));
  return static_cast<std::uint32_t>(scene.textures.size() - 1);
}

std::uint32_t add_textured(Scene& scene, Texture texture, float mirror) {
  const std::string name = texture.name;
  const std::uint32_t index = add_texture(scene, std::move(texture));
  return add_material(scene, make_textured(name, index, glm::vec3(1), mirror));
}

Material make_paint(std::string name, const glm::vec3& colour, float mirror) {
  Material m;
  m.name = std::move(name);
  m.base_colour = colour;
  m.mirror = mirror;
  return m;
}

Material make_metal(std::string name, const glm::vec3& tint, float mirror) {
  Material m = make_paint(std::move(name), tint, mirror);
  m.mirror_tint = tint;
  return m;
}

Material make_glass(std::string name, const glm::vec3& colour, float ior) {
  Material m = make_paint(std::move(name), colour);
  m.transmission = 1;
  m.ior = ior;
  return m;
}

Material make_lamp(std::string name, const glm::vec3& emission) {
  Material m = make_paint(std::move(name), glm::vec3(0));
  m.emission = emission;
  return m;
}

Material make_textured(std::string name, std::uint32_t texture, const glm::vec3& colour, float mirror) {
  Material m = make_paint(std::move(name), colour, mirror);
  m.base_texture.texture = texture;
  return m;
}

std::uint64_t count_triangles(const Scene& scene) {
  std::uint64_t sum = 0;
  for (const Instance& instance : scene.instances) sum += scene.meshes[instance.mesh].triangles.size();
  return sum;
}

namespace {

constexpr float kSharp = 0.766F;  // cosine of 40 degrees

template <class P>
std::vector<P> curve_through(std::span<const P> points, std::uint32_t steps) {
  std::vector<P> out;
  const std::size_t last = points.size() - 1;
  for (std::size_t k = 0; k < last; ++k) {
    const P a = points[k == 0 ? 0 : k - 1], b = points[k], c = points[k + 1], d = points[std::min(k + 2, last)];
    for (std::uint32_t i = 0; i < steps; ++i) {
      const float t = static_cast<float>(i) / static_cast<float>(steps);
      out.push_back(b + 0.5F * t * (c - a + t * (2.0F * a - 5.0F * b + 4.0F * c - d + t * (3.0F * (b - c) + d - a))));
    }
  }
  out.push_back(points[last]);
  return out;
}

/// Returns twice the signed area of a triangle, positive if it is counter-clockwise.
float turn_area(const glm::vec2& a, const glm::vec2& b, const glm::vec2& c) {
  return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

/// Splits a simple polygon into triangles by ear clipping.
std::vector<std::array<std::uint32_t, 3>> triangulate_outline(std::span<const glm::vec2> outline) {
  std::vector<std::uint32_t> left(outline.size());
  for (std::uint32_t i = 0; i < left.size(); ++i) left[i] = i;
  std::vector<std::array<std::uint32_t, 3>> triangles;
  const auto is_ear = [&](std::size_t k) {
    const std::size_t n = left.size();
    const std::uint32_t ia = left[(k + n - 1) % n], ib = left[k], ic = left[(k + 1) % n];
    const glm::vec2 a = outline[ia], b = outline[ib], c = outline[ic];
    if (turn_area(a, b, c) <= 0) return false;
    return std::ranges::none_of(left, [&](std::uint32_t i) {
      const glm::vec2 p = outline[i];
      return i != ia && i != ib && i != ic && turn_area(a, b, p) >= 0 && turn_area(b, c, p) >= 0 &&
             turn_area(c, a, p) >= 0;
    });
  };
  while (left.size() > 3) {
    std::size_t ear = 0;
    while (ear < left.size() && !is_ear(ear)) ++ear;
    if (ear == left.size()) ear = 0;
    const std::size_t n = left.size();
    triangles.push_back({left[(ear + n - 1) % n], left[ear], left[(ear + 1) % n]});
    left.erase(left.begin() + static_cast<std::ptrdiff_t>(ear));
  }
  triangles.push_back({left[0], left[1], left[2]});
  return triangles;
}

void add_cap(Mesh& mesh, std::span<const glm::vec3> ring, const glm::vec3& normal) {
  const auto first = static_cast<std::uint32_t>(mesh.positions.size());
  glm::vec3 centre(0);
  for (const glm::vec3& p : ring) centre += p;
  centre /= static_cast<float>(ring.size());
  mesh.positions.push_back(centre);
  mesh.normals.push_back(normal);
  mesh.uvs.emplace_back(0.5F, 0.5F);
  for (const glm::vec3& p : ring) {
    mesh.positions.push_back(p);
    mesh.normals.push_back(normal);
    mesh.uvs.emplace_back(0.5F, 0.5F);
  }
  const auto sides = static_cast<std::uint32_t>(ring.size());
  for (std::uint32_t i = 0; i < sides; ++i) {
    const std::uint32_t a = first + 1 + i, b = first + 1 + (i + 1) % sides;
    const bool faces = glm::dot(glm::cross(mesh.positions[a] - centre, mesh.positions[b] - centre), normal) > 0;
    mesh.triangles.push_back(faces ? std::array{first, a, b} : std::array{first, b, a});
  }
}

}  // namespace

std::vector<glm::vec2> catmull_rom(std::span<const glm::vec2> points, std::uint32_t steps) {
  return curve_through(points, steps);
}
std::vector<glm::vec3> catmull_rom(std::span<const glm::vec3> points, std::uint32_t steps) {
  return curve_through(points, steps);
}

Mesh make_lathe(std::string name, std::span<const glm::vec2> profile, std::uint32_t segments) {
  Mesh mesh;
  mesh.name = std::move(name);
  const std::size_t stretches = profile.size() - 1;
  std::vector<glm::vec2> outward(stretches);
  for (std::size_t k = 0; k < stretches; ++k) {
    const glm::vec2 along = profile[k + 1] - profile[k];
    outward[k] = glm::dot(along, along) > 0 ? glm::normalize(glm::vec2(along.y, -along.x)) : glm::vec2(1, 0);
  }
  const auto normal_at = [&](std::size_t stretch, std::size_t point) {
    const std::size_t other =
        point == stretch ? (stretch == 0 ? 0 : stretch - 1) : std::min(stretch + 1, stretches - 1);
    const bool sharp = glm::dot(outward[stretch], outward[other]) < kSharp;
    return sharp ? outward[stretch] : glm::normalize(outward[stretch] + outward[other]);
  };
  std::vector<glm::vec2> rounds;
  for (std::uint32_t i = 0; i <= segments; ++i) {
    const float u = static_cast<float>(i) / static_cast<float>(segments);
    rounds.push_back(circle_point(i == segments ? 0.0 : static_cast<double>(u)));
  }
  for (std::size_t k = 0; k < stretches; ++k) {
    const auto first = static_cast<std::uint32_t>(mesh.positions.size());
    for (const std::size_t point : {k, k + 1}) {
      const glm::vec2 normal = normal_at(k, point);
      for (std::uint32_t i = 0; i <= segments; ++i) {
        const float u = static_cast<float>(i) / static_cast<float>(segments);
        const glm::vec2 round = rounds[i];
        // Vertices are clockwise, so that u grows to the right and v up as seen from outside.
        mesh.positions.emplace_back(profile[point].x * round.x, profile[point].y, -profile[point].x * round.y);
        mesh.normals.push_back(glm::normalize(glm::vec3(normal.x * round.x, normal.y, -normal.x * round.y)));
        mesh.uvs.emplace_back(u, static_cast<float>(point) / static_cast<float>(stretches));
      }
    }
    add_grid(mesh, first, segments, 1);
  }
  remove_collapsed_triangles(mesh);
  return mesh;
}

Mesh make_cylinder(std::string name, float radius, float height, std::uint32_t segments) {
  return make_cone(std::move(name), radius, radius, height, segments);
}

Mesh make_cone(std::string name, float radius, float top_radius, float height, std::uint32_t segments) {
  std::vector<glm::vec2> profile{{0, 0}, {radius, 0}, {top_radius, height}};
  if (top_radius > 0) profile.emplace_back(0, height);
  return make_lathe(std::move(name), profile, segments);
}

Mesh make_torus(std::string name, float radius, float tube_radius, std::uint32_t segments, std::uint32_t sides) {
  std::vector<glm::vec2> profile;
  for (std::uint32_t i = 0; i <= sides; ++i) {
    const glm::vec2 round = circle_point(i == sides ? 0.0 : static_cast<double>(i) / sides);
    profile.push_back(glm::vec2(radius, 0) + tube_radius * round);
  }
  return make_lathe(std::move(name), profile, segments);
}

Mesh make_tube(std::string name, std::span<const glm::vec3> path, std::span<const float> radii, std::uint32_t sides) {
  Mesh mesh;
  mesh.name = std::move(name);
  const std::size_t last = path.size() - 1;
  const auto radius = [&](std::size_t k) { return radii[std::min(k, radii.size() - 1)]; };
  const auto tangent = [&](std::size_t k) {
    return glm::normalize(path[std::min(k + 1, last)] - path[k == 0 ? 0 : k - 1]);
  };
  glm::vec3 along = tangent(0);
  glm::vec3 right =
      glm::normalize(glm::cross(along, std::abs(along.y) < 0.9F ? glm::vec3(0, 1, 0) : glm::vec3(1, 0, 0)));
  for (std::size_t k = 0; k <= last; ++k) {
    along = tangent(k);
    right = glm::normalize(right - along * glm::dot(right, along));  // parallel transport: no twist
    const glm::vec3 up = glm::cross(along, right);
    for (std::uint32_t i = 0; i <= sides; ++i) {
      const glm::vec2 round = circle_point(i == sides ? 0.0 : static_cast<double>(i) / sides);
      const glm::vec3 normal = right * round.x + up * round.y;
      mesh.positions.push_back(path[k] + radius(k) * normal);
      mesh.normals.push_back(normal);
      mesh.uvs.emplace_back(static_cast<float>(i) / static_cast<float>(sides),
                            static_cast<float>(k) / static_cast<float>(last));
    }
  }
  add_grid(mesh, 0, sides, static_cast<std::uint32_t>(last));
  remove_collapsed_triangles(mesh);
  for (const std::size_t end : {std::size_t{0}, last}) {
    if (!(radius(end) > 0)) continue;
    const auto from = mesh.positions.begin() + static_cast<std::ptrdiff_t>(end * (sides + 1));
    const std::vector<glm::vec3> ring(from, from + sides);
    add_cap(mesh, ring, end == 0 ? -tangent(0) : tangent(last));
  }
  return mesh;
}

Mesh make_extrusion(std::string name, std::span<const glm::vec2> outline, float depth) {
  Mesh mesh;
  mesh.name = std::move(name);
  const std::vector<std::array<std::uint32_t, 3>> face = triangulate_outline(outline);
  for (const bool front : {true, false}) {
    const auto first = static_cast<std::uint32_t>(mesh.positions.size());
    for (const glm::vec2& p : outline) {
      mesh.positions.emplace_back(p, front ? depth : 0.0F);
      mesh.normals.emplace_back(0, 0, front ? 1 : -1);
      mesh.uvs.push_back(p);
    }
    for (const auto& t : face) {
      mesh.triangles.push_back({first + t[0], first + t[front ? 1 : 2], first + t[front ? 2 : 1]});
    }
  }
  float round = 0;
  for (std::size_t k = 0; k < outline.size(); ++k) {
    const glm::vec2 a = outline[k], b = outline[(k + 1) % outline.size()];
    const float length = glm::length(b - a);
    const glm::vec3 normal = glm::vec3(b.y - a.y, a.x - b.x, 0) / length;
    const auto first = static_cast<std::uint32_t>(mesh.positions.size());
    for (const float z : {0.0F, depth}) {
      for (const bool is_b : {false, true}) {
        mesh.positions.emplace_back(is_b ? b : a, z);
        mesh.normals.push_back(normal);
        mesh.uvs.emplace_back(round + (is_b ? length : 0.0F), z);
      }
    }
    add_grid(mesh, first, 1, 1);
    round += length;
  }
  return mesh;
}

Outline& Outline::line_to(float radius, float height) {
  points_.emplace_back(radius, height);
  return *this;
}

Outline& Outline::arc_to(float radius, float height, float bulge) {
  constexpr int kSteps = 12;
  const glm::vec2 a = points_.back(), b(radius, height);
  const glm::vec2 along = glm::normalize(b - a);
  const glm::vec2 middle = 0.5F * (a + b) + 2 * bulge * glm::vec2(along.y, -along.x);
  for (int k = 1; k <= kSteps; ++k) {
    const float t = static_cast<float>(k) / kSteps, s = 1 - t;
    points_.push_back(s * s * a + 2 * s * t * middle + t * t * b);
  }
  points_.back() = b;
  return *this;
}

Outline& Outline::add_arc(const glm::vec2& centre, float radius, double from, double to) {
  constexpr int kSteps = 16;
  for (int k = 0; k <= kSteps; ++k) {
    const glm::vec2 p = centre + radius * circle_point(from + (to - from) * k / kSteps);
    if (glm::length(p - points_.back()) > 1e-6F) points_.emplace_back(std::max(p.x, 0.0F), p.y);
  }
  return *this;
}

std::vector<glm::vec2> simplify_line(std::vector<glm::vec2> points, std::size_t count) {
  while (points.size() > std::max<std::size_t>(count, 2)) {
    // Removes the point whose triangle with its neighbours is smallest (Visvalingam).
    std::size_t smallest = 1;
    float least = -1;
    for (std::size_t k = 1; k + 1 < points.size(); ++k) {
      const glm::vec2 a = points[k] - points[k - 1], b = points[k + 1] - points[k - 1];
      const float area = std::abs(a.x * b.y - a.y * b.x);
      if (least < 0 || area < least) least = area, smallest = k;
    }
    points.erase(points.begin() + static_cast<std::ptrdiff_t>(smallest));
  }
  return points;
}

Mesh make_turned(std::string name, const std::vector<glm::vec2>& profile, std::uint32_t segments,
                 const std::function<glm::vec3(float around, std::size_t k, const glm::vec3& point)>& shape) {
  const auto rows = static_cast<std::uint32_t>(profile.size() - 1);
  return make_surface(
      std::move(name), segments, rows,
      [&](float s, float t) {
        const auto k = static_cast<std::size_t>(t * static_cast<float>(rows) + 0.5F);
        const glm::vec2 way = circle_point(static_cast<double>(s));
        return shape(s, k, {profile[k].x * way.x, profile[k].y, -profile[k].x * way.y});
      },
      true);
}

}  // namespace traces
