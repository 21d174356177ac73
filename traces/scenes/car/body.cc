#include "traces/scenes/car/body.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>
#include <vector>

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/vector_relational.hpp>

#include "traces/scenes/modelling/shapes.h"
#include "traces/scenes/modelling/trigonometry.h"

namespace traces::car {
namespace {

constexpr float kNose = 2.23F, kTail = -2.20F, kSill = 0.17F;
constexpr float kRoll = 0.06F, kRolled = 0.09F;  // height, and fraction of the width, of the body's rounded shoulder

/// Interpolates smoothly between points (x, value), in ascending order of x.
float interpolate_keys(std::span<const glm::vec2> keys, float x) {
  std::size_t k = 0;
  while (k + 2 < keys.size() && x > keys[k + 1].x) ++k;
  const glm::vec2 b = keys[k], c = keys[k + 1];
  const glm::vec2 a = keys[k == 0 ? 0 : k - 1], d = keys[std::min(k + 2, keys.size() - 1)];
  const float width = c.x - b.x, t = std::clamp((x - b.x) / width, 0.0F, 1.0F);
  const float m0 = width * (c.y - a.y) / (c.x - a.x), m1 = width * (d.y - b.y) / (d.x - b.x);
  return b.y + t * (m0 + t * (3 * (c.y - b.y) - 2 * m0 - m1 + t * (2 * (b.y - c.y) + m0 + m1)));
}

/// Returns a smooth bump: 1 at 0, falling to 0 at -1 and 1.
float smooth_bump(float a) {
  const float s = std::max(1 - a * a, 0.0F);
  return s * s;
}

constexpr glm::vec2 kShoulder[] = {{-2.20F, 0.80F}, {-1.90F, 0.855F}, {-1.31F, 0.885F}, {-0.60F, 0.850F},
                                   {0.0F, 0.825F},  {0.70F, 0.805F},  {1.30F, 0.790F},  {1.75F, 0.715F},
                                   {2.05F, 0.630F}, {2.23F, 0.545F}};
constexpr glm::vec2 kMiddle[] = {{-2.20F, 0.86F}, {-1.90F, 0.925F}, {-1.31F, 0.95F}, {0.0F, 0.94F},  {0.90F, 0.905F},
                                 {1.30F, 0.855F}, {1.75F, 0.765F},  {2.05F, 0.665F}, {2.23F, 0.560F}};
constexpr glm::vec2 kBottom[] = {{-2.20F, 0.36F}, {-2.05F, 0.29F}, {-1.75F, 0.21F}, {-1.3F, kSill},
                                 {1.65F, kSill},  {1.90F, 0.165F}, {2.10F, 0.175F}, {2.23F, 0.24F}};
constexpr glm::vec2 kWidth[] = {{-2.20F, 0.91F}, {-1.70F, 0.925F}, {-1.31F, 0.93F}, {-0.60F, 0.90F},
                                {0.20F, 0.885F}, {0.80F, 0.89F},   {1.30F, 0.905F}, {2.23F, 0.89F}};

/// Returns the width of the car at x as a fraction of its largest width. Nose and tail are rounded in plan view.
float width_fraction(float x) {
  const float front = std::clamp((x - 1.10F) / (kNose - 1.10F), 0.0F, 1.0F);
  const float rear = std::clamp((-1.25F - x) / (-1.25F - kTail), 0.0F, 1.0F);
  const float e = std::max(front, rear), e2 = e * e;
  return std::sqrt(std::sqrt(std::max(1 - e2 * e2 * (front > 0 ? 1.0F : e2), 0.0F)));
}

/// Returns the x offset by which nose and tail of the car recede above and below the height at which they project most.
float lean_offset(float x, float y) {
  const float front = glm::smoothstep(1.7F, kNose, x), rear = glm::smoothstep(1.75F, -kTail, -x);
  const float low = (y - 0.42F) / 0.30F, high = (y - 0.72F) / 0.40F;
  return -front * 0.10F * low * low + rear * 0.16F * high * high;
}

float bottom_height(float x) {
  float y = interpolate_keys(kBottom, x);
  for (const float axle : {kFrontAxle, kRearAxle}) {
    const float rest = kArch * kArch - (x - axle) * (x - axle);
    if (rest > 0) y = std::max(y, kWheel + std::sqrt(rest));
  }
  return y;
}

/// Returns a point on the edge of a wheel arch in the xy plane, with the axle at the origin. `share` runs from 0 to 1:
/// up from the sill, around the wheel, down.
glm::vec2 arch_edge_point(float share) {
  constexpr float kStraight = 0.12F, kDrop = kWheel - kSill;
  if (share < kStraight) return {kArch, -kDrop * (1 - share / kStraight)};
  if (share > 1 - kStraight) return {-kArch, -kDrop * (1 - (1 - share) / kStraight)};
  return kArch * circle_point(0.5 * static_cast<double>((share - kStraight) / (1 - 2 * kStraight)));
}

/// Returns the x positions of the cross-sections of the car's body, which are denser at the ends of arches, nose and
/// tail.
std::vector<float> section_positions(const Detail& detail) {
  constexpr float kReach = kArch - 1e-4F;  // beyond it, the edge drops to the sill
  std::vector<float> xs{kTail};
  const auto add = [&](float to, double at_one, bool slow_start, bool slow_end) {
    const float from = xs.back();
    const std::uint32_t steps = detail.cell_count(at_one, 4);
    for (std::uint32_t k = 1; k <= steps; ++k) {
      const float t = static_cast<float>(k) / static_cast<float>(steps);
      float s = t;
      if (slow_start && slow_end) s = 0.5F - 0.5F * cos_turns(0.5 * static_cast<double>(t));
      if (slow_start && !slow_end) s = t * t * (2 - t);
      if (!slow_start && slow_end) s = 1 - (1 - t) * (1 - t) * (1 + t);
      xs.push_back(k == steps ? to : from + s * (to - from));
    }
  };
  add(kRearAxle - kArch, 16, true, false);
  xs.push_back(kRearAxle - kReach);
  add(kRearAxle + kReach, 26, true, true);
  xs.push_back(kRearAxle + kArch);
  add(kFrontAxle - kArch, 24, false, false);
  xs.push_back(kFrontAxle - kReach);
  add(kFrontAxle + kReach, 26, true, true);
  xs.push_back(kFrontAxle + kArch);
  add(kNose, 20, false, true);
  return xs;
}

}  // namespace

float half_width_at(float x, float y) {
  const float u = std::clamp((y - kSill) / (interpolate_keys(kShoulder, x) - kSill), 0.0F, 1.0F);
  float z = interpolate_keys(kWidth, x) - 0.045F * (1 - u) * (1 - u) - 0.055F * u * u * u;
  z -= 0.045F * smooth_bump((x - 0.05F) / 1.05F) * smooth_bump((u - 0.42F) / 0.36F);  // recesses the doors
  for (const float axle : {kFrontAxle, kRearAxle}) {
    const float away = std::sqrt((x - axle) * (x - axle) + (y - kWheel) * (y - kWheel));
    z += 0.030F * (1 - glm::smoothstep(kArch, kArch + 0.17F, away));
  }
  return z * width_fraction(x);
}

Mesh make_shell(const Detail& detail) {
  const std::vector<float> xs = section_positions(detail);
  const std::uint32_t side = detail.cell_count(20, 5), top = detail.cell_count(18, 6), columns = 2 * (side + top);
  return make_surface("shell", columns, static_cast<std::uint32_t>(xs.size() - 1), [&](float s, float t) {
    const auto row = static_cast<std::size_t>(t * static_cast<float>(xs.size() - 1) + 0.5F);
    const auto column = static_cast<std::uint32_t>(s * static_cast<float>(columns) + 0.5F);
    const float sign = 2 * column < columns ? -1.0F : 1.0F;
    const std::uint32_t k = std::min(column, columns - column);
    const float x = xs[row], shoulder = interpolate_keys(kShoulder, x) - kRoll;
    float y = 0, z = 0;
    if (k <= side) {
      const float share = static_cast<float>(k) / static_cast<float>(side);
      y = glm::mix(bottom_height(x), shoulder, share);
      z = half_width_at(x, y);
    } else {
      // A third of the rows belongs to the rounded shoulder.
      const std::uint32_t rolling = top / 3;
      const float share = k - side <= rolling ? kRolled * static_cast<float>(k - side) / static_cast<float>(rolling)
                                              : kRolled + (1 - kRolled) * static_cast<float>(k - side - rolling) /
                                                              static_cast<float>(top - rolling);
      const float out = 1 - share, past = std::max((out - 1 + kRolled) / kRolled, 0.0F);
      z = half_width_at(x, shoulder) * out;
      y = shoulder + kRoll * (1 - past * past) +
          (interpolate_keys(kMiddle, x) - interpolate_keys(kShoulder, x)) * (1 - out * out);
      // Fenders are higher than the bonnet, which has a rib on each side.
      const float fenders =
          0.050F * smooth_bump((x - kFrontAxle - 0.05F) / 0.75F) + 0.030F * smooth_bump((x - kRearAxle) / 0.7F);
      y += fenders * smooth_bump((z - 0.68F) / 0.24F) * width_fraction(x);
      y += 0.014F * smooth_bump((x - 1.35F) / 0.75F) * smooth_bump((z - 0.36F) / 0.09F);
    }
    return glm::vec3(x + lean_offset(x, y), y, sign * z);
  });
}

Mesh make_cabin(const Detail& detail) {
  static constexpr glm::vec2 kRoof[] = {{-2.02F, 0.88F}, {-1.75F, 0.985F}, {-1.3F, 1.135F},
                                        {-0.8F, 1.245F}, {-0.3F, 1.285F},  {0.10F, 1.260F},
                                        {0.45F, 1.150F}, {0.85F, 0.970F},  {1.10F, 0.85F}};
  static constexpr glm::vec2 kHalf[] = {{-2.02F, 0.40F}, {-1.75F, 0.53F}, {-1.3F, 0.68F}, {-0.8F, 0.765F},
                                        {-0.2F, 0.79F},  {0.35F, 0.77F},  {0.80F, 0.70F}, {1.10F, 0.60F}};
  constexpr float kFoot = 0.78F, kFrom = -2.02F, kTo = 1.10F;
  const auto power = [](float c) { return std::sqrt(c * std::sqrt(c)); };  // c to the power 3/4: fuller than an ellipse
  return make_surface("cabin", 2 * detail.cell_count(20, 6), detail.cell_count(50, 12), [&](float s, float t) {
    const float x = kFrom + (kTo - kFrom) * t;
    const glm::vec2 q = circle_point(0.5 - 0.5 * static_cast<double>(s));
    const float height = std::max(interpolate_keys(kRoof, x) - kFoot, 0.01F), up = power(std::max(q.y, 0.0F));
    const float half = interpolate_keys(kHalf, x) * (1 - 0.24F * up * height / 0.5F);
    return glm::vec3(x, kFoot + height * up, (q.x < 0 ? -half : half) * power(std::abs(q.x)));
  });
}

Mesh make_underbody(const Detail& detail) {
  Mesh dark;
  for (const float axle : {kFrontAxle, kRearAxle}) {
    for (const float sign : {-1.0F, 1.0F}) {
      const Mesh liner = make_surface("", detail.cell_count(20, 6), 2, [&](float s, float t) {
        const glm::vec2 edge = arch_edge_point(1 - s);
        const float x = axle + edge.x, y = kWheel + edge.y;
        const float outer = half_width_at(x, y) - 0.015F;
        return glm::vec3(x, y, sign * (outer - (sign > 0 ? t : 1 - t) * (outer - 0.45F)));
      });
      append_mesh(dark, liner);
    }
  }
  append_mesh(dark, make_box("", {-0.92F, 0.15F, -0.80F}, {0.90F, 0.30F, 0.80F}));
  append_mesh(dark, make_box("", {-1.95F, 0.22F, -0.50F}, {1.98F, 0.50F, 0.50F}));
  dark.name = "underbody";
  return dark;
}

Mesh make_arch_lips(const Detail& detail) {
  Mesh lips;
  for (const float axle : {kFrontAxle, kRearAxle}) {
    for (const float sign : {-1.0F, 1.0F}) {
      std::vector<glm::vec3> path;
      const std::uint32_t steps = detail.cell_count(28, 8);
      for (std::uint32_t k = 0; k <= steps; ++k) {
        const glm::vec2 edge = arch_edge_point(static_cast<float>(k) / static_cast<float>(steps));
        const float x = axle + edge.x, y = kWheel + edge.y;
        path.emplace_back(x, y, sign * (half_width_at(x, y) - 0.004F));
      }
      const float radius[] = {0.011F};
      append_mesh(lips, make_tube("", path, radius, detail.cell_count(6, 4)));
    }
  }
  lips.name = "arch lips";
  return lips;
}

namespace {

glm::vec2 point_on_line(const std::vector<glm::vec2>& line, float t) {
  const float at = t * static_cast<float>(line.size() - 1);
  const auto k = std::min(static_cast<std::size_t>(at), line.size() - 2);
  return line[k] + (at - static_cast<float>(k)) * (line[k + 1] - line[k]);
}

/// How a patch is projected: the world axes of its x and y, and the axis of projection with its sign.
struct PatchProjection {
  int x, y, along;
  float sign;
};

PatchProjection projection_of(From from) {
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
  const std::vector<glm::vec2> a = catmull_rom(first, kFine), b = catmull_rom(second, kFine);
  return make_surface("", columns, rows, [&](float s, float t) {
    return glm::vec3(point_on_line(a, s) + t * (point_on_line(b, s) - point_on_line(a, s)), 0);
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

Mesh drape_patch(const Mesh& body, const Mesh& patch, From from, float lift) {
  const PatchProjection to = projection_of(from);
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
