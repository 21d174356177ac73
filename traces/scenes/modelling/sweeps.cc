#include "traces/scenes/modelling/sweeps.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include <glm/geometric.hpp>

#include "traces/scenes/modelling/shapes.h"
#include "traces/scenes/modelling/trigonometry.h"

namespace traces {
namespace {

constexpr float kSharp = 0.766F;  // cosine of 40 degrees

template <class P>
std::vector<P> through(std::span<const P> points, std::uint32_t steps) {
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

/// Returns twice the area of the triangle, positive if counter-clockwise.
float turn(const glm::vec2& a, const glm::vec2& b, const glm::vec2& c) {
  return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

/// Splits a simple polygon into triangles by ear clipping.
std::vector<std::array<std::uint32_t, 3>> triangulate(std::span<const glm::vec2> outline) {
  std::vector<std::uint32_t> left(outline.size());
  for (std::uint32_t i = 0; i < left.size(); ++i) left[i] = i;
  std::vector<std::array<std::uint32_t, 3>> triangles;
  const auto is_ear = [&](std::size_t k) {
    const std::size_t n = left.size();
    const std::uint32_t ia = left[(k + n - 1) % n], ib = left[k], ic = left[(k + 1) % n];
    const glm::vec2 a = outline[ia], b = outline[ib], c = outline[ic];
    if (turn(a, b, c) <= 0) return false;
    return std::ranges::none_of(left, [&](std::uint32_t i) {
      const glm::vec2 p = outline[i];
      return i != ia && i != ib && i != ic && turn(a, b, p) >= 0 && turn(b, c, p) >= 0 && turn(c, a, p) >= 0;
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

std::vector<glm::vec2> smoothed(std::span<const glm::vec2> points, std::uint32_t steps) {
  return through(points, steps);
}
std::vector<glm::vec3> smoothed(std::span<const glm::vec3> points, std::uint32_t steps) {
  return through(points, steps);
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
    rounds.push_back(on_circle(i == segments ? 0.0 : static_cast<double>(u)));
  }
  for (std::size_t k = 0; k < stretches; ++k) {
    const auto first = static_cast<std::uint32_t>(mesh.positions.size());
    for (const std::size_t point : {k, k + 1}) {
      const glm::vec2 normal = normal_at(k, point);
      for (std::uint32_t i = 0; i <= segments; ++i) {
        const float u = static_cast<float>(i) / static_cast<float>(segments);
        const glm::vec2 round = rounds[i];
        // Clockwise, so that u grows to the right and v up seen from outside.
        mesh.positions.emplace_back(profile[point].x * round.x, profile[point].y, -profile[point].x * round.y);
        mesh.normals.push_back(glm::normalize(glm::vec3(normal.x * round.x, normal.y, -normal.x * round.y)));
        mesh.uvs.emplace_back(u, static_cast<float>(point) / static_cast<float>(stretches));
      }
    }
    add_grid(mesh, first, segments, 1);
  }
  std::erase_if(mesh.triangles, [&](const auto& t) {
    const glm::vec3 a = mesh.positions[t[0]], b = mesh.positions[t[1]], c = mesh.positions[t[2]];
    return a == b || b == c || c == a;
  });
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
    const glm::vec2 round = on_circle(i == sides ? 0.0 : static_cast<double>(i) / sides);
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
      const glm::vec2 round = on_circle(i == sides ? 0.0 : static_cast<double>(i) / sides);
      const glm::vec3 normal = right * round.x + up * round.y;
      mesh.positions.push_back(path[k] + radius(k) * normal);
      mesh.normals.push_back(normal);
      mesh.uvs.emplace_back(static_cast<float>(i) / static_cast<float>(sides),
                            static_cast<float>(k) / static_cast<float>(last));
    }
  }
  add_grid(mesh, 0, sides, static_cast<std::uint32_t>(last));
  std::erase_if(mesh.triangles, [&](const auto& t) {
    const glm::vec3 a = mesh.positions[t[0]], b = mesh.positions[t[1]], c = mesh.positions[t[2]];
    return a == b || b == c || c == a;
  });
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
  const std::vector<std::array<std::uint32_t, 3>> face = triangulate(outline);
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

}  // namespace traces
