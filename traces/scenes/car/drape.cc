#include "traces/scenes/car/drape.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/vector_relational.hpp>

#include "traces/scenes/modelling/shapes.h"
#include "traces/scenes/modelling/sweeps.h"

namespace traces::car {
namespace {

glm::vec2 on_line(const std::vector<glm::vec2>& line, float t) {
  const float at = t * static_cast<float>(line.size() - 1);
  const auto k = std::min(static_cast<std::size_t>(at), line.size() - 2);
  return line[k] + (at - static_cast<float>(k)) * (line[k + 1] - line[k]);
}

/// World axes of a patch's x and y, and the axis of projection with its sign.
struct Throw {
  int x, y, along;
  float sign;
};

Throw way(From from) {
  switch (from) {
    case From::kFront:
      return {2, 1, 0, -1};
    case From::kRear:
      return {2, 1, 0, 1};
    case From::kLeft:
      return {0, 1, 2, 1};
    case From::kRight:
      return {0, 1, 2, -1};
    default:
      return {0, 2, 1, -1};
  }
}

}  // namespace

Mesh make_patch(std::span<const glm::vec2> first, std::span<const glm::vec2> second, std::uint32_t columns,
                std::uint32_t rows) {
  constexpr std::uint32_t kFine = 8;
  const std::vector<glm::vec2> a = smoothed(first, kFine), b = smoothed(second, kFine);
  return make_surface("", columns, rows, [&](float s, float t) {
    return glm::vec3(on_line(a, s) + t * (on_line(b, s) - on_line(a, s)), 0);
  });
}

Mesh make_strip(std::span<const glm::vec2> line, float width, std::uint32_t columns) {
  std::vector<glm::vec2> first, second;
  for (std::size_t k = 0; k < line.size(); ++k) {
    const glm::vec2 along = glm::normalize(line[std::min(k + 1, line.size() - 1)] - line[k == 0 ? 0 : k - 1]);
    const glm::vec2 side = 0.5F * width * glm::vec2(-along.y, along.x);
    first.push_back(line[k] - side);
    second.push_back(line[k] + side);
  }
  return make_patch(first, second, columns, 1);
}

Mesh draped(const Mesh& body, const Mesh& patch, From from, float lift) {
  const Throw to = way(from);
  std::vector<char> is_hit(patch.positions.size(), 0);
  std::vector<float> best(patch.positions.size());
  Mesh out = patch;
  glm::vec2 lowest(patch.positions.front()), highest = lowest;
  for (const glm::vec3& p : patch.positions) {
    lowest = glm::min(lowest, glm::vec2(p));
    highest = glm::max(highest, glm::vec2(p));
  }
  for (const auto& t : body.triangles) {
    const glm::vec3 p[3] = {body.positions[t[0]], body.positions[t[1]], body.positions[t[2]]};
    const auto flat = [&](const glm::vec3& q) { return glm::vec2(q[to.x], q[to.y]); };
    const glm::vec2 a = flat(p[0]), ab = flat(p[1]) - a, ac = flat(p[2]) - a;
    const float area = ab.x * ac.y - ab.y * ac.x;
    if (std::abs(area) < 1e-10F) continue;
    const glm::vec2 low = glm::min(a, glm::min(flat(p[1]), flat(p[2]))),
                    high = glm::max(a, glm::max(flat(p[1]), flat(p[2])));
    if (glm::any(glm::lessThan(high, lowest)) || glm::any(glm::greaterThan(low, highest))) continue;
    for (std::size_t k = 0; k < patch.positions.size(); ++k) {
      const glm::vec2 q(patch.positions[k]);
      if (q.x < low.x || q.y < low.y || q.x > high.x || q.y > high.y) continue;
      const glm::vec2 aq = q - a;
      const float v = (aq.x * ac.y - aq.y * ac.x) / area, w = (ab.x * aq.y - ab.y * aq.x) / area;
      if (v < 0 || w < 0 || v + w > 1) continue;
      const glm::vec3 point = p[0] + v * (p[1] - p[0]) + w * (p[2] - p[0]);
      const float height = -to.sign * point[to.along];  // the nearest surface is hit first
      if (is_hit[k] != 0 && height <= best[k]) continue;
      is_hit[k] = 1;
      best[k] = height;
      out.normals[k] =
          glm::normalize((1 - v - w) * body.normals[t[0]] + v * body.normals[t[1]] + w * body.normals[t[2]]);
      out.positions[k] = point + lift * out.normals[k];
    }
  }
  std::erase_if(out.triangles, [&](const auto& t) { return is_hit[t[0]] + is_hit[t[1]] + is_hit[t[2]] < 3; });
  for (std::size_t k = 0; k < is_hit.size(); ++k) {
    if (is_hit[k] == 0) out.positions[k] = body.positions.front(), out.normals[k] = {0, 1, 0};
  }
  for (auto& t : out.triangles) {
    const glm::vec3 a = out.positions[t[0]], b = out.positions[t[1]], c = out.positions[t[2]];
    if (glm::dot(glm::cross(b - a, c - a), out.normals[t[0]]) < 0) std::swap(t[1], t[2]);
  }
  return out;
}

}  // namespace traces::car
