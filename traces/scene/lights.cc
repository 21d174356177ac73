#include "traces/scene/lights.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <glm/matrix.hpp>

#include "traces/scene/bounds.h"
#include "traces/scene/texture_mean.h"

namespace traces {
namespace {

float strongest_channel(const glm::vec3& c) { return std::max({c.x, c.y, c.z}); }

/// Surface of an emissive instance in world space.
struct Emitter {
  double area = 0;
  glm::dvec3 moment{0};  ///< sum of area x centroid
  glm::dvec3 normal{0};  ///< sum of area x normal
  Bounds bounds;
};

Emitter measure(const Mesh& mesh, const glm::mat4& to_world) {
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

/// Returns the direction in which light leaves the emitter, towards the middle of the scene.
glm::vec3 way_out(const Emitter& e, const glm::vec3& centroid, const glm::vec3& middle) {
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

/// Returns an orthonormal frame at `position` whose -z is `direction`.
glm::mat4 frame(const glm::vec3& position, const glm::vec3& direction) {
  const glm::vec3 other = std::abs(direction.y) < 0.9F ? glm::vec3(0, 1, 0) : glm::vec3(1, 0, 0);
  const glm::vec3 right = glm::normalize(glm::cross(other, -direction));
  return {glm::vec4(right, 0), glm::vec4(glm::cross(-direction, right), 0), glm::vec4(-direction, 0),
          glm::vec4(position, 1)};
}

/// True if the matrix has no inverse, within single precision.
bool is_flat(const glm::dmat3& m) {
  return std::abs(glm::determinant(m)) <= 1e-6 * glm::length(m[0]) * glm::length(m[1]) * glm::length(m[2]);
}

/// Returns the mean emission of each material; zero for a material that is not a lamp.
std::vector<glm::vec3> mean_emissions(const Scene& scene) {
  std::vector<glm::vec3> means;
  for (const Material& material : scene.materials) {
    means.push_back(material.casts_light ? material.emission : glm::vec3(0));
    if (strongest_channel(means.back()) < 1 || !material.emission_texture.used()) continue;
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
    const Emitter e = measure(mesh, instance.to_world);
    if (!(e.area > 0)) continue;
    const glm::vec3 centroid(e.moment / e.area);
    const glm::vec3 way = way_out(e, centroid, world.centre());
    const glm::vec3 corner = glm::mix(e.bounds.lower, e.bounds.upper, glm::greaterThan(way, glm::vec3(0)));
    Light light;
    light.kind = Light::Kind::kPoint;
    light.position = centroid + way * (std::max(glm::dot(corner - centroid, way), 0.0F) + 1e-3F * world.diagonal());
    light.direction = way;
    light.intensity = static_cast<float>(e.area) * emission;
    const bool skinned = mesh.deformation != nullptr && mesh.deformation->skin != kNone;
    if (instance.node != kNone && !skinned && !is_flat(glm::dmat3(instance.to_world))) {
      light.node = instance.node;
      light.in_node = glm::mat4(glm::inverse(glm::dmat4(instance.to_world)) * glm::dmat4(frame(light.position, way)));
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
    expose_lights(scene);
  }
}

}  // namespace traces
