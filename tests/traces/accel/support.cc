#include "support.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <numbers>
#include <utility>

#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>

#include "traces/accel/build/two_level.h"
#include "traces/accel/bvh_tracer.h"
#include "traces/accel/ray_tests.h"

namespace traces {

glm::vec3 Dice::point(float low, float high) {
  const float x = between(low, high), y = between(low, high), z = between(low, high);
  return {x, y, z};
}

glm::vec3 Dice::direction() {
  for (;;) {
    const glm::vec3 p = point();
    const float length = glm::length(p);
    if (length > 0.01F && length < 1) return p / length;
  }
}

Scene scene_of(Mesh mesh) {
  Scene scene;
  scene.meshes.push_back(std::move(mesh));
  scene.instances.emplace_back();
  return scene;
}

namespace {

void add_triangle(Mesh& mesh, const glm::vec3& a, const glm::vec3& b, const glm::vec3& c) {
  const auto first = static_cast<std::uint32_t>(mesh.positions.size());
  mesh.positions.insert(mesh.positions.end(), {a, b, c});
  mesh.triangles.push_back({first, first + 1, first + 2});
}

glm::vec3 grid_point(Dice& dice) {
  const auto pick = [&] { return static_cast<float>(dice.below(17)) / 8 - 1; };
  const float x = pick(), y = pick(), z = pick();
  return {x, y, z};
}

}  // namespace

Scene triangle_soup(std::uint32_t count, float size, std::uint64_t seed) {
  Dice dice(seed);
  Mesh mesh;
  for (std::uint32_t i = 0; i < count; ++i) {
    const glm::vec3 at = dice.point();
    const glm::vec3 a = at + dice.point(-size, size), b = at + dice.point(-size, size),
                    c = at + dice.point(-size, size);
    add_triangle(mesh, a, b, c);
  }
  return scene_of(std::move(mesh));
}

Scene grid_soup(std::uint32_t count, std::uint64_t seed) {
  Dice dice(seed);
  Mesh mesh;
  for (std::uint32_t i = 0; i < count; ++i) {
    glm::vec3 a = grid_point(dice), b = grid_point(dice), c = grid_point(dice);
    const int axis = static_cast<int>(dice.below(4));
    if (axis < 3) b[axis] = c[axis] = a[axis];
    add_triangle(mesh, a, b, c);
  }
  return scene_of(std::move(mesh));
}

Scene sphere(std::uint32_t rings, std::uint32_t segments) {
  Mesh mesh;
  mesh.positions.emplace_back(0, 1, 0);
  for (std::uint32_t r = 1; r < rings; ++r) {
    const double theta = std::numbers::pi * r / rings;
    for (std::uint32_t s = 0; s < segments; ++s) {
      const double phi = 2 * std::numbers::pi * s / segments;
      mesh.positions.emplace_back(std::sin(theta) * std::cos(phi), std::cos(theta), std::sin(theta) * std::sin(phi));
    }
  }
  mesh.positions.emplace_back(0, -1, 0);
  const auto last = static_cast<std::uint32_t>(mesh.positions.size() - 1);
  const auto at = [&](std::uint32_t ring, std::uint32_t s) { return 1 + (ring - 1) * segments + s % segments; };
  for (std::uint32_t s = 0; s < segments; ++s) {
    mesh.triangles.push_back({0, at(1, s + 1), at(1, s)});
    mesh.triangles.push_back({last, at(rings - 1, s), at(rings - 1, s + 1)});
    for (std::uint32_t r = 1; r + 1 < rings; ++r) {
      mesh.triangles.push_back({at(r, s), at(r, s + 1), at(r + 1, s)});
      mesh.triangles.push_back({at(r, s + 1), at(r + 1, s + 1), at(r + 1, s)});
    }
  }
  return scene_of(std::move(mesh));
}

Scene one_triangle() {
  Mesh mesh;
  add_triangle(mesh, {0, 0, 0}, {1, 0, 0}, {0, 1, 0});
  return scene_of(std::move(mesh));
}

Scene scattered(std::uint32_t count, std::uint64_t seed) {
  Scene scene;
  scene.meshes = {triangle_soup(60, 0.4F, seed).meshes[0], sphere(6, 8).meshes[0], one_triangle().meshes[0], Mesh{}};
  Dice dice(seed);
  for (std::uint32_t i = 0; i < count; ++i) {
    Instance& instance = scene.instances.emplace_back();
    instance.mesh = i % 4;
    const glm::vec3 axis = dice.direction();
    const glm::quat turn = glm::normalize(glm::quat(dice.between(-1, 1), axis.x, axis.y, axis.z));
    glm::vec3 scale(dice.between(0.05F, 0.5F), dice.between(0.05F, 0.5F), dice.between(0.05F, 0.5F));
    if (dice.below(3) == 0) scale.y = -scale.y;
    if (i % 11 == 6) scale.z = 0;
    instance.to_world = glm::mat4_cast(turn);
    for (int a = 0; a < 3; ++a) instance.to_world[a] *= scale[a];
    instance.to_world[3] = glm::vec4(dice.point(), 1);
  }
  return scene;
}

Scene with_transparent_triangles(Scene scene) {
  scene.materials = {{}, {.alpha = Material::Alpha::kMask}, {.transmission = 1}};
  const Mesh all = scene.meshes[0];
  scene.meshes.resize(3, all);
  scene.instances.resize(3);
  for (std::uint32_t m = 0; m < 3; ++m) {
    Mesh& mesh = scene.meshes[m];
    mesh.material = scene.instances[m].mesh = m;
    mesh.triangles.clear();
    for (std::size_t i = m; i < all.triangles.size(); i += 3) mesh.triangles.push_back(all.triangles[i]);
  }
  return scene;
}

Scene single_sided(Scene scene) {
  if (scene.materials.empty()) scene.materials.emplace_back();
  for (Material& material : scene.materials) material.double_sided = false;
  return scene;
}

std::vector<Ray> random_rays(std::uint32_t count, std::uint64_t seed) {
  Dice dice(seed);
  std::vector<Ray> rays(count);
  for (Ray& ray : rays) {
    ray.origin = dice.point(-2, 2);
    ray.direction = dice.direction() * dice.between(0.1F, 10);
    if (dice.below(4) == 0) ray.t_max = dice.between(0.01F, 2);
  }
  return rays;
}

std::vector<Ray> grid_rays(std::uint32_t count, std::uint64_t seed) {
  Dice dice(seed);
  std::vector<Ray> rays(count);
  for (Ray& ray : rays) {
    ray.origin = grid_point(dice);
    ray.direction = grid_point(dice);
    const auto axis = static_cast<int>(dice.below(3));
    switch (dice.below(4)) {
      case 0:  // along an axis
        ray.direction = glm::vec3(dice.below(2) == 0 ? 0.0F : -0.0F);
        ray.direction[axis] = dice.below(2) == 0 ? 1.0F : -1.0F;
        break;
      case 1:  // in a plane of the grid
        ray.direction[axis] = dice.below(2) == 0 ? 0.0F : -0.0F;
        break;
      case 2:  // along an axis, from anywhere
        ray.origin = dice.point();
        ray.direction = glm::vec3(0);
        ray.direction[axis] = 1;
        break;
      default:
        break;
    }
    if (ray.direction == glm::vec3(0)) ray.direction = {0, 1, 0};
    if (dice.below(4) == 0) ray.t_max = static_cast<float>(dice.below(8)) / 8;
  }
  return rays;
}

std::vector<Hit> trace(const Tracer& tracer, const std::vector<Ray>& rays, RayKind kind) {
  std::vector<Hit> hits(rays.size());
  tracer.trace(rays, kind, hits, nullptr);
  return hits;
}

Hit test_all(const MemoryImage& image, const Ray& ray) {
  Hit best;
  best.t = std::min(ray.t_max, std::numeric_limits<float>::max());
  std::uint32_t best_instance = 0;
  const auto test = [&](const Ray& seen, std::uint32_t instance, std::uint32_t first, std::uint32_t count) {
    const RayTriangles<PortableLanes> triangles(seen);
    for (std::uint32_t i = first; i < first + count; ++i) {
      const auto result = triangles.test_triangles(&image.triangles[i], 1);
      const float t = result.t.v[0];
      if ((result.inside_mask() & ~result.culled_mask(&image.triangles[i], 1) & 1U) == 0 ||
          !(t >= ray.t_min && t <= best.t))
        continue;
      const auto rank = [&](std::uint32_t of, std::uint32_t triangle) {
        return std::pair(of, image.triangles[triangle].source);
      };
      if (best.is_hit() && t == best.t && rank(instance, i) > rank(best_instance, best.triangle)) continue;
      const float u = std::clamp(result.u.v[0] / result.sum.v[0], 0.0F, 1.0F);
      best = {t, u, std::clamp(result.v.v[0] / result.sum.v[0], 0.0F, 1 - u), i};
      best_instance = instance;
    }
  };
  if (!image.has_two_levels()) test(ray, 0, 0, static_cast<std::uint32_t>(image.triangles.size()));
  for (std::uint32_t i = 0; i < image.instances.size(); ++i) {
    if (image.tree_of[i] == kNone) continue;
    const ObjectTree& tree = image.trees[image.tree_of[i]];
    test(to_object_space(image.instances[i], ray), i, tree.first_triangle, tree.triangles);
  }
  if (!best.is_hit()) return {};
  best.triangle |= image.triangles[best.triangle].hit_flags();
  return image.has_two_levels() ? with_instance(best, best_instance) : best;
}

std::uint64_t count_different(const std::vector<Hit>& a, const std::vector<Hit>& b) {
  std::uint64_t n = 0;
  for (std::size_t i = 0; i < a.size(); ++i) n += std::memcmp(&a[i], &b[i], sizeof(Hit)) != 0 ? 1U : 0U;
  return n;
}

std::uint64_t count_different_in_portable(const MemoryImage& image, const std::vector<Ray>& rays) {
  std::uint64_t different = 0;
  for (const RayKind kind : {RayKind::kPrimary, RayKind::kShadow}) {
    std::vector<Hit> native(rays.size()), portable(rays.size());
    std::vector<std::uint32_t> native_words, native_begin, portable_words, portable_begin;
    WalkSink native_walk{native_words, native_begin}, portable_walk{portable_words, portable_begin};
    BvhTracer(image).trace(rays, kind, native, &native_walk);
    BvhTracer(image, BvhTracer::Arithmetic::kPortable).trace(rays, kind, portable, &portable_walk);
    different += count_different(native, portable);
    different += native_words != portable_words || native_begin != portable_begin ? 1 : 0;
  }
  return different;
}

}  // namespace traces
