#include "traces/scene/lights.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>
#include <vector>

#include <glm/matrix.hpp>

#include "sim/hash.h"
#include "traces/scene/bounds.h"
#include "traces/scene/texels.h"

namespace traces {
namespace {

float strongest_channel(const glm::vec3& c) { return std::max({c.x, c.y, c.z}); }

/// Area, position, normal and bounds of the surface of an emissive instance, in world space.
struct Emitter {
  double area = 0;
  glm::dvec3 moment{0};  ///< sum of area x centroid over all triangles
  glm::dvec3 normal{0};  ///< sum of area x normal over all triangles
  Bounds bounds;
};

Emitter measure_emitter(const Mesh& mesh, const glm::mat4& to_world) {
  Emitter e;
  for (const auto& triangle : mesh.triangles) {
    glm::dvec3 p[3];
    for (int k = 0; k < 3; ++k) {
      const glm::vec3 world(to_world * glm::vec4(mesh.positions[triangle[static_cast<std::size_t>(k)]], 1));
      e.bounds.add(world);
      p[k] = world;
    }
    const glm::dvec3 normal = 0.5 * glm::cross(p[1] - p[0], p[2] - p[0]);
    const double area = glm::length(normal);
    e.area += area;
    e.moment += area / 3 * (p[0] + p[1] + p[2]);
    e.normal += normal;
  }
  return e;
}

/// Returns the direction in which light leaves an emitter: along its mean normal or, if it is closed, the shortest side
/// of its box. Of the two directions, it is the one towards the middle of the scene.
glm::vec3 light_exit_direction(const Emitter& e, const glm::vec3& centroid, const glm::vec3& middle) {
  glm::vec3 way{0};
  if (glm::length(e.normal) > 0.5 * e.area) {
    way = glm::vec3(glm::normalize(e.normal));
  } else {
    const glm::vec3 size = e.bounds.upper - e.bounds.lower;
    const int shortest = size.x < size.y ? (size.x < size.z ? 0 : 2) : (size.y < size.z ? 1 : 2);
    way[shortest] = 1;
  }
  return glm::dot(way, middle - centroid) < 0 ? -way : way;
}

/// Returns an orthonormal coordinate system at `position` whose -z is `direction`.
glm::mat4 light_frame(const glm::vec3& position, const glm::vec3& direction) {
  const glm::vec3 other = std::abs(direction.y) < 0.9F ? glm::vec3(0, 1, 0) : glm::vec3(1, 0, 0);
  const glm::vec3 right = glm::normalize(glm::cross(other, -direction));
  return {glm::vec4(right, 0), glm::vec4(glm::cross(-direction, right), 0), glm::vec4(-direction, 0),
          glm::vec4(position, 1)};
}

/// True if the matrix has no inverse in single precision.
bool is_singular(const glm::dmat3& m) {
  return std::abs(glm::determinant(m)) <= 1e-6 * glm::length(m[0]) * glm::length(m[1]) * glm::length(m[2]);
}

/// Returns the mean emission of each material; zero for a material whose surfaces become no lights.
std::vector<glm::vec3> mean_emissions(const Scene& scene) {
  std::vector<glm::vec3> means;
  for (const Material& material : scene.materials) {
    means.push_back(material.casts_light ? material.emission : glm::vec3(0));
    if (strongest_channel(means.back()) < 1 || !material.emission_texture.is_used()) continue;
    means.back() *= glm::vec3(mean_texel(scene.textures[material.emission_texture.texture]));
  }
  return means;
}

}  // namespace

void add_emitter_lights(Scene& scene) {
  const Bounds world = world_bounds(scene);
  const std::vector<glm::vec3> emissions = mean_emissions(scene);
  std::vector<Light> found;
  for (const Instance& instance : scene.instances) {
    const Mesh& mesh = scene.meshes[instance.mesh];
    const glm::vec3 emission = emissions[mesh.material];
    if (strongest_channel(emission) < 1) continue;
    const Emitter e = measure_emitter(mesh, instance.to_world);
    if (!(e.area > 0)) continue;
    const glm::vec3 centroid(e.moment / e.area);
    const glm::vec3 way = light_exit_direction(e, centroid, world.centre());
    const glm::vec3 corner = glm::mix(e.bounds.lower, e.bounds.upper, glm::greaterThan(way, glm::vec3(0)));
    Light light;
    light.kind = Light::Kind::kPoint;
    light.position = centroid + way * (std::max(glm::dot(corner - centroid, way), 0.0F) + 1e-3F * world.diagonal());
    light.direction = way;
    light.intensity = static_cast<float>(e.area) * emission;
    const bool skinned = mesh.deformation != nullptr && mesh.deformation->skin != kNone;
    if (instance.node != kNone && !skinned && !is_singular(glm::dmat3(instance.to_world))) {
      light.node = instance.node;
      light.in_node =
          glm::mat4(glm::inverse(glm::dmat4(instance.to_world)) * glm::dmat4(light_frame(light.position, way)));
    }
    found.push_back(light);
  }
  std::stable_sort(found.begin(), found.end(), [](const Light& a, const Light& b) {
    return strongest_channel(a.intensity) > strongest_channel(b.intensity);
  });
  for (std::size_t i = 0; i < std::min(found.size(), kMaxEmitterLights); ++i) {
    if (strongest_channel(found[i].intensity) < 0.01F * strongest_channel(found[0].intensity)) break;
    scene.lights.push_back(found[i]);
  }
  for (Material& material : scene.materials) material.emission /= std::max(strongest_channel(material.emission), 1.0F);
}

void add_default_light(Scene& scene) {
  if (!scene.lights.empty()) return;
  Light sun;
  sun.kind = Light::Kind::kDirectional;
  sun.direction = glm::normalize(glm::vec3(-0.4F, -0.8F, -0.55F));
  sun.intensity = glm::vec3(0.75F, 0.72F, 0.66F);
  scene.lights.push_back(sun);
  scene.ambient = glm::vec3(0.22F, 0.24F, 0.28F);
}

void finish_lights(Scene& scene) {
  add_emitter_lights(scene);
  if (scene.lights.empty()) {
    add_default_light(scene);
  } else {
    scale_lights_to_exposure(scene);
  }
}

namespace {

struct Point {
  glm::vec3 position, normal;
};

/// True for a light source or an unlit surface, whose colour does not depend on incident light.
bool is_self_luminous(const Material& material) {
  return material.emission != glm::vec3(0) && !(material.casts_light && material.emission_texture.is_used());
}

/// Calls visit(corners), in world space, for each triangle whose material does not shine.
template <class Visit>
void for_each_triangle(const Scene& scene, Visit visit) {
  for (const Instance& instance : scene.instances) {
    const Mesh& mesh = scene.meshes[instance.mesh];
    if (is_self_luminous(scene.materials[mesh.material])) continue;
    for (const auto& triangle : mesh.triangles) {
      glm::vec3 p[3];
      for (std::size_t k = 0; k < 3; ++k)
        p[k] = glm::vec3(instance.to_world * glm::vec4(mesh.positions[triangle[k]], 1));
      visit(p);
    }
  }
}

/// Returns `count` points that are spread evenly over the area of all surfaces.
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
      float u = sim::hash_to_unit_float(sim::hash(points.size(), 0));
      float v = sim::hash_to_unit_float(sim::hash(points.size(), 1));
      if (u + v > 1) u = 1 - u, v = 1 - v;
      points.push_back({p[0] + u * (p[1] - p[0]) + v * (p[2] - p[0]), normal / length});
    }
  });
  return points;
}

glm::vec3 irradiance_at(const Scene& scene, const Point& at) {
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

/// Returns the irradiance at the points that a camera sees in a 2:1 picture, each weighted by its picture area.
std::vector<Sample> irradiance_in_view(const Camera& camera, const Scene& scene, const std::vector<Point>& points,
                                       float nearest) {
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
    const glm::vec3 e = irradiance_at(scene, point);
    samples.push_back({std::max({e.x, e.y, e.z}), std::abs(facing) / (distance * distance)});
  }
  return samples;
}

/// Returns a weighted percentile of the irradiance: samples up to it have the fraction `rank` of the total weight.
float weighted_percentile(std::vector<Sample> samples, float rank) {
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

/// Returns the irradiance (percentile kRank) of the surfaces that the first camera sees, or of all surfaces if it sees
/// none.
float view_brightness(const Scene& scene, const std::vector<Point>& points) {
  float level = 0;
  if (!scene.cameras.empty()) {
    level = weighted_percentile(
        irradiance_in_view(scene.cameras[0], scene, points, 0.02F * world_bounds(scene).diagonal()), kRank);
  }
  if (!(level > 0)) {
    std::vector<Sample> everywhere;
    for (Point point : points) {
      const glm::vec3 front = irradiance_at(scene, point);
      point.normal = -point.normal;
      const glm::vec3 e = glm::max(front, irradiance_at(scene, point));
      everywhere.push_back({std::max({e.x, e.y, e.z}), 1});
    }
    level = weighted_percentile(std::move(everywhere), kRank);
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
    const float level = view_brightness(scene, points);
    if (level > most) {
      most = level;
      strongest = light;
    }
  }
  scene.lights.clear();
  if (most >= 0) scene.lights.push_back(strongest);
}

void scale_lights_to_exposure(Scene& scene) {
  scene.ambient = glm::vec3(kAmbient);
  const float level = view_brightness(scene, spread_points(scene, kPoints));
  const float scale = kTargetIrradiance / level;
  if (!(level > 0) || !std::isfinite(scale)) return;
  for (Light& light : scene.lights) light.intensity *= scale;
}

}  // namespace traces
