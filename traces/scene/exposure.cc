#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>
#include <vector>

#include <glm/matrix.hpp>

#include "sim/hash.h"
#include "traces/scene/bounds.h"
#include "traces/scene/lights.h"

namespace traces {
namespace {

struct Point {
  glm::vec3 position, normal;
};

/// True for a lamp or an unlit surface, whose colour does not depend on incident light.
bool shines(const Material& material) {
  return material.emission != glm::vec3(0) && !(material.casts_light && material.emission_texture.used());
}

/// Calls visit(triangle's corners), in world space, for each triangle that does not shine.
template <class Visit>
void for_each_triangle(const Scene& scene, Visit visit) {
  for (const Instance& instance : scene.instances) {
    const Mesh& mesh = scene.meshes[instance.mesh];
    if (shines(scene.materials[mesh.material])) continue;
    for (const auto& triangle : mesh.triangles) {
      glm::vec3 p[3];
      for (std::size_t k = 0; k < 3; ++k)
        p[k] = glm::vec3(instance.to_world * glm::vec4(mesh.positions[triangle[k]], 1));
      visit(p);
    }
  }
}

/// Returns `count` points spread evenly over the area of all surfaces.
std::vector<Point> spread_points(const Scene& scene, std::size_t count) {
  double total = 0;
  for_each_triangle(scene, [&](const glm::vec3* p) {
    total += static_cast<double>(glm::length(glm::cross(p[1] - p[0], p[2] - p[0])));
  });
  std::vector<Point> points;
  if (!(total > 0)) return points;
  points.reserve(count);
  const double step = total / static_cast<double>(count);
  double passed = 0;
  for_each_triangle(scene, [&](const glm::vec3* p) {
    const glm::vec3 normal = glm::cross(p[1] - p[0], p[2] - p[0]);
    const float length = glm::length(normal);
    passed += static_cast<double>(length);
    while (points.size() < count && passed > (static_cast<double>(points.size()) + 0.5) * step) {
      float u = sim::unit_float(sim::hash(points.size(), 0));
      float v = sim::unit_float(sim::hash(points.size(), 1));
      if (u + v > 1) u = 1 - u, v = 1 - v;
      points.push_back({p[0] + u * (p[1] - p[0]) + v * (p[2] - p[0]), normal / length});
    }
  });
  return points;
}

glm::vec3 irradiance(const Scene& scene, const Point& at) {
  glm::vec3 sum{0};
  for (const Light& light : scene.lights) {
    if (light.kind == Light::Kind::kDirectional) {
      sum += light.intensity * std::max(-glm::dot(light.direction, at.normal), 0.0F);
      continue;
    }
    const glm::vec3 d = light.position - at.position;
    const float squared = glm::dot(d, d);
    if (!(squared > 0)) continue;
    const glm::vec3 way = d / std::sqrt(squared);
    float share = std::max(glm::dot(way, at.normal), 0.0F);
    if (light.kind == Light::Kind::kSpot && -glm::dot(way, light.direction) < light.cos_outer) share = 0;
    if (light.range > 0) {
      const float far = squared / (light.range * light.range);
      share *= std::max(1 - far * far, 0.0F);  // the falloff that KHR_lights_punctual recommends
    }
    sum += light.intensity * (share / squared);
  }
  return sum;
}

struct Sample {
  float irradiance, weight;
};

/// Returns the irradiance at the points in the camera's view (2:1), each weighted by the picture area that it
/// represents.
std::vector<Sample> seen_by(const Camera& camera, const Scene& scene, const std::vector<Point>& points, float nearest) {
  std::vector<Sample> samples;
  const glm::mat4 to_camera = glm::inverse(camera.to_world);
  const float slope = std::tan(0.5F * camera.vertical_fov);
  for (Point point : points) {
    const glm::vec3 seen(to_camera * glm::vec4(point.position, 1));
    if (seen.z >= 0 || std::abs(seen.y) > -seen.z * slope || std::abs(seen.x) > -seen.z * slope * 2) continue;
    const glm::vec3 d = glm::vec3(camera.to_world[3]) - point.position;
    const float distance = std::max(glm::length(d), nearest);
    const float facing = glm::dot(d, point.normal) / distance;
    if (facing < 0) point.normal = -point.normal;
    const glm::vec3 e = irradiance(scene, point);
    samples.push_back({std::max({e.x, e.y, e.z}), std::abs(facing) / (distance * distance)});
  }
  return samples;
}

/// Returns the irradiance below which a share `rank` of the total weight falls.
float percentile(std::vector<Sample> samples, float rank) {
  std::sort(samples.begin(), samples.end(),
            [](const Sample& a, const Sample& b) { return a.irradiance < b.irradiance; });
  const float total =
      std::accumulate(samples.begin(), samples.end(), 0.0F, [](float sum, const Sample& s) { return sum + s.weight; });
  float passed = 0;
  for (const Sample& s : samples) {
    passed += s.weight;
    if (passed >= rank * total) return s.irradiance;
  }
  return samples.empty() ? 0 : samples.back().irradiance;
}

constexpr std::size_t kPoints = 16384;
constexpr float kRank = 0.9F;

/// Returns how bright the lights make the first camera's view, or the whole scene if the camera sees nothing.
float brightness(const Scene& scene, const std::vector<Point>& points) {
  float level = 0;
  if (!scene.cameras.empty()) {
    level = percentile(seen_by(scene.cameras[0], scene, points, 0.02F * world_bounds(scene).diagonal()), kRank);
  }
  if (!(level > 0)) {
    std::vector<Sample> everywhere;
    for (Point point : points) {
      const glm::vec3 front = irradiance(scene, point);
      point.normal = -point.normal;
      const glm::vec3 e = glm::max(front, irradiance(scene, point));
      everywhere.push_back({std::max({e.x, e.y, e.z}), 1});
    }
    level = percentile(std::move(everywhere), kRank);
  }
  return level;
}

}  // namespace

void keep_strongest_light(Scene& scene) {
  const std::vector<Point> points = spread_points(scene, kPoints);
  const std::vector<Light> all = std::exchange(scene.lights, {});
  float most = -1;
  Light strongest;
  for (const Light& light : all) {
    scene.lights = {light};
    const float level = brightness(scene, points);
    if (level > most) {
      most = level;
      strongest = light;
    }
  }
  scene.lights.clear();
  if (most >= 0) scene.lights.push_back(strongest);
}

void expose_lights(Scene& scene) {
  scene.ambient = glm::vec3(kAmbient);
  const float level = brightness(scene, spread_points(scene, kPoints));
  const float scale = kTargetIrradiance / level;
  if (!(level > 0) || !std::isfinite(scale)) return;
  for (Light& light : scene.lights) light.intensity *= scale;
}

}  // namespace traces
